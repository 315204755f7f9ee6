// Runs a scene under one perturbation, and compares it with the scene as it is.
#include "samples/weft/hardening.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "engine/simulation.h"
#include "samples/weft/console.h"
#include "samples/weft/hard_measures.h"

namespace weft::command {

namespace {

// Of a mean edge; with contacts also of a thickness, since a start must not cross.
constexpr double kJitterOfEdge = 0.01, kJitterOfThickness = 0.1;
constexpr double kStrainFactor = 2, kStrainMore = 0.005;   // rms at the end: this times as much and this much more

double mean_edge(const CookedFabric& fabric) {
  double sum = 0;
  std::size_t count = 0;
  for (const StretchLink& link : fabric.links)
    if (!link.only_pulls) sum += link.rest, ++count;
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

Result<void> jitter(Simulation& simulation, std::uint32_t seed) {
  double most = kJitterOfEdge * mean_edge(simulation.fabric());
  if (contacts_on(simulation.scene()))
    for (const Cloth& cloth : simulation.scene().cloths) most = std::min(most, kJitterOfThickness * cloth.fabric.thickness);
  auto positions = simulation.read_positions();
  if (!positions) return fail(positions.why());
  std::mt19937 words(seed);
  const auto part = [&] { return static_cast<float>(most * (2 * (words() / 4294967296.0) - 1)); };
  for (gpu::vec4& p : *positions) {
    const float x = part(), y = part(), z = part();
    if (p.w > 0) p = {p.x + x, p.y + y, p.z + z, p.w};
  }
  return simulation.write_positions(*positions);
}

// As a host does when its character passes a door. Velocities stay.
Result<void> teleport(Simulation& simulation, Vec3 by) {
  auto positions = simulation.read_positions();
  if (!positions) return fail(positions.why());
  for (gpu::vec4& p : *positions) p = {p.x + by.x, p.y + by.y, p.z + by.z, p.w};
  if (auto done = simulation.write_positions(*positions); !done) return done;
  const std::vector<ColliderPose> poses(simulation.colliders().begin(), simulation.colliders().end());
  for (std::uint32_t k = 0; k < poses.size(); ++k) {
    ColliderPose there = poses[k];
    there.centre = there.centre + by;
    if (auto done = simulation.place_collider(k, there); !done) return done;
  }
  return {};
}

Vec3 place(const gpu::vec4& p) { return {p.x, p.y, p.z}; }

double box_diagonal(const std::vector<Mesh>& meshes, std::size_t cloths) {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  for (const Mesh& mesh : std::span(meshes).first(cloths))
    for (const Vec3& p : mesh.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  return length(high - low);
}

// Measures what is to hold after every frame.
Result<void> measure(const Simulation& simulation, PerturbedRun& seen) {
  const auto positions = simulation.read_positions();
  if (!positions) return fail(positions.why());
  const Glance at{simulation.scene(), simulation.fabric(), {}, {}, *positions, {}, simulation.time(), 0, 0, simulation.counts()};
  seen.pins_off = std::max(seen.pins_off, figure::pins_off(at));
  seen.non_finite = std::max(seen.non_finite, static_cast<std::uint32_t>(figure::not_finite(at)));
  if (contacts_on(simulation.scene())) seen.crossings = std::max(seen.crossings, static_cast<std::uint64_t>(figure::crossings(at)));
  return {};
}

}  // namespace

Result<PerturbedRun> run_perturbed(const compute::Device& device, const Scene& scene, const Perturbation& perturbation,
                                   std::uint32_t frames) {
  using Clock = std::chrono::steady_clock;
  const double frame = perturbation.frame > 0 ? perturbation.frame : 1 / scene.solver.rate;
  const double seconds = frames / scene.solver.rate, halfway = std::floor(seconds / 2 / frame) * frame;
  auto created = Simulation::create(device, perturbed(scene, perturbation, halfway, frame));
  if (!created) return created.take_error();
  Simulation& simulation = **created;
  if (perturbation.seed)
    if (auto done = jitter(simulation, *perturbation.seed); !done) return done.take_error();

  PerturbedRun seen;
  const Clock::time_point start = Clock::now();
  bool changed = false;   // whether what happens halfway has happened
  // Against the clock of what was simulated: a clamped frame leaves time to be made up for. Half a substep is rounding.
  while (simulation.time() < seconds - 0.5 * simulation.fabric().h && !interrupted()) {
    const bool now = !changed && simulation.time() >= halfway - 0.5 * simulation.fabric().h;
    changed |= now;
    if (now && perturbation.teleport != Vec3{})
      if (auto done = teleport(simulation, perturbation.teleport); !done) return done.take_error();
    const double left = seconds - simulation.time();
    const auto advance =
        simulation.advance(now && perturbation.hitch > 0 ? perturbation.hitch : std::min(frame, left + 0.25 * simulation.fabric().h));
    if (!advance) return fail(perturbation.name, ", at ", simulation.time(), " s: ", advance.why());
    seen.clamped += advance->clamped;
    if (auto done = measure(simulation, seen); !done) return done.take_error();
  }
  seen.wall = std::chrono::duration<double>(Clock::now() - start).count();
  seen.simulated = simulation.time();
  seen.overflowed = simulation.counts().contacts_overflowed;
  const auto end = simulation.read_positions();
  if (!end) return fail(end.why());
  seen.strain = measure_strain(simulation.fabric(), *end);
  const std::size_t cloths = simulation.fabric().cloths.size();
  if (simulation.counts().truncated > 0)   // else no anchor was held either
    for (const gpu::vec4& rest : simulation.fabric().rest)
      seen.kinematic_lag_limit = std::max(seen.kinematic_lag_limit, simulation.scene().contacts.kinematic_lag_limit * double(rest.w));
  seen.size = box_diagonal(simulation.meshes(), cloths) / perturbation.size;
  const Vec3 back = simulation.origin() - (perturbation.away + perturbation.jolt + perturbation.teleport);   // small, however far away
  const auto smaller = static_cast<float>(1 / perturbation.size);
  for (std::uint32_t i = 0; i < cloth_particles(simulation.fabric()); ++i) seen.pose.push_back(smaller * (place((*end)[i]) + back));
  return seen;
}

Difference difference(const PerturbedRun& with, const PerturbedRun& without) {
  double sum[3] = {}, squares = 0;
  const std::size_t count = std::min(with.pose.size(), without.pose.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 d = with.pose[i] - without.pose[i];
    sum[0] += d.x, sum[1] += d.y, sum[2] += d.z;
    squares += double(d.x) * d.x + double(d.y) * d.y + double(d.z) * d.z;
  }
  const double n = static_cast<double>(count) * without.size;
  return {std::hypot(sum[0], sum[1], sum[2]) / n, std::sqrt(squares / static_cast<double>(count)) / without.size};
}

std::vector<std::string> broken(const Perturbation& perturbation, const PerturbedRun& with, const PerturbedRun& without, double band) {
  std::vector<std::string> broken;
  if (with.non_finite > 0) broken.push_back("not finite");
  if (!(with.pins_off <= with.kinematic_lag_limit)) broken.push_back("pins");
  if (with.overflowed > 0) broken.push_back("contacts lost");
  if (with.crossings > 0) broken.push_back("crossings");   // a scene that crosses by itself does not hold either
  if (perturbation.same_strain && !(with.strain.rms <= kStrainFactor * without.strain.rms + kStrainMore)) broken.push_back("strain");
  if (std::isinf(perturbation.bands)) return broken;
  const Difference off = difference(with, without);
  if (!(off.mean <= perturbation.bands * band)) broken.push_back("sag");
  if (!(off.shape <= perturbation.bands * kShapeBands * band)) broken.push_back("shape");
  return broken;
}

}  // namespace weft::command
