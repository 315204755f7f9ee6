// Runs single dispatches of the real solver on states that a test makes up, for comparison with the twins.
#pragma once

#include <algorithm>
#include <bit>
#include <optional>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "compute/commands.h"
#include "engine/effects/buffers.h"
#include "engine/solve/solver.h"
#include "shaders/motion/motion.ref.h"
#include "shaders/jacobi.ref.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/without_contacts.h"

namespace weft {

using Random = std::mt19937_64;
inline double between(Random& random, double low, double high) { return std::uniform_real_distribution(low, high)(random); }
inline gpu::vec4 anywhere(Random& random, double size, float w) {
  const auto one = [&] { return static_cast<float>(between(random, -size, size)); };
  return {one(), one(), one(), w};
}

inline reference::Vector vector(const gpu::vec4& v) { return {v.x, v.y, v.z}; }
inline reference::Vector vector(const gpu::vec3& v) { return {v.x, v.y, v.z}; }
inline reference::Points points(const std::vector<gpu::vec4>& values) {
  reference::Points p;
  for (const gpu::vec4& v : values) p.push_back(vector(v));
  return p;
}
inline std::vector<double> inverse_masses(const CookedFabric& fabric) {
  std::vector<double> w;
  for (const gpu::vec4& x : fabric.positions) w.push_back(x.w);
  return w;
}

// Relative rounding of one operation. An iteration of any pass adds up some twenty of them per particle, on values no larger
// than the scene: that is what tolerances here are made of.
inline constexpr double kRounding = 0x1p-24;

/// Particles that nothing ties together: a fabric with empty lists. About one in eight is held.
inline CookedFabric loose_particles(Random& random, std::uint32_t count, const SolverSettings& solver) {
  CookedFabric fabric;
  fabric.h = 1 / (solver.rate * substeps_of(solver));
  for (std::uint32_t i = 0; i < count; ++i) {
    fabric.positions.push_back(anywhere(random, 1, i % 8 == 3 ? 0 : static_cast<float>(between(random, 1, 100))));
    fabric.velocities.push_back(anywhere(random, 2, std::bit_cast<float>(i % 2)));
    fabric.split_weights.push_back(fabric.positions.back().w);
    fabric.iterate_weights.push_back(fabric.positions.back().w);
    fabric.stretch.rows.push_back({0, 0});
    fabric.surface_rows.push_back({i, 0, 0, 0});
  }
  for (const double damping : {0.1, 2.0})
    fabric.materials.push_back({static_cast<float>(std::exp(-damping * fabric.h)), 0.4f, 0.002f, static_cast<float>(fabric.materials.size())});
  fabric.cloths.push_back({"loose", 0, count, 0, count, 0, 0});
  return fabric;
}

/// Adds links between random particles, with the places, masses and responses that cooking gives them. `padded`: rows of one length.
inline void link_up(CookedFabric& fabric, const std::vector<StretchLink>& links, Averaging averaging, std::uint32_t iterations = 1,
                    bool padded = false) {
  std::vector<std::uint32_t> uses(fabric.positions.size());
  for (const StretchLink& link : links) ++uses[link.a], ++uses[link.b];
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const float w = fabric.positions[i].w, count = std::max(1.f, static_cast<float>(uses[i]));
    fabric.split_weights[i] = w * (averaging == Averaging::mass_split ? count : 1);
    fabric.iterate_weights[i] = iterations > 1 ? fabric.split_weights[i] : averaging == Averaging::mass_split ? w : w / count;
  }
  std::vector<std::vector<gpu::uvec2>> lists(fabric.positions.size());
  fabric.links.clear();
  for (const StretchLink& link : links) {
    const double weight = double(fabric.split_weights[link.a]) + fabric.split_weights[link.b];
    const double gain = weight > 0 ? 1 / (weight + link.compliance / (fabric.h * fabric.h)) : 0;
    const float response = iterations > 1 ? link.compliance : static_cast<float>(gain);
    const gpu::uvec2 to_b = gpu::pack_link({link.b, link.rest, response, link.only_pulls});
    lists[link.a].push_back(to_b);
    lists[link.b].push_back(gpu::pack_link({link.a, link.rest, response, link.only_pulls}));
    const gpu::Link packed = gpu::unpack_link(to_b.x, to_b.y);
    fabric.links.push_back({link.a, link.b, packed.rest, iterations > 1 ? packed.response : link.compliance, packed.only_pulls,
                            iterations > 1 ? 0 : packed.response});
  }
  fabric.stretch = {};
  std::size_t longest = 0;
  for (const auto& list : lists) longest = std::max(longest, list.size() + list.size() % 2);
  if (padded) fabric.stretch.stride = static_cast<std::uint32_t>(longest / 2);
  for (std::uint32_t i = 0; i < lists.size(); ++i) {
    fabric.stretch.rows.push_back({static_cast<std::uint32_t>(fabric.stretch.pairs.size()), static_cast<std::uint32_t>(lists[i].size())});
    // The last place of an odd row holds a link of no length to the particle itself.
    if (lists[i].size() % 2 == 1) lists[i].push_back({i, 0});
    if (padded) lists[i].resize(longest, {i, 0});
    for (std::size_t k = 0; k < lists[i].size(); k += 2)
      fabric.stretch.pairs.push_back({lists[i][k].x, lists[i][k].y, lists[i][k + 1].x, lists[i][k + 1].y});
  }
}

/// A frame of so many substeps, nothing moving.
inline FrameInput frame_of(std::uint32_t substeps) {
  FrameInput input;
  input.substeps = substeps;
  return input;
}

inline constexpr double kDampings[] = {0.1, 2.0};   // those of loose_particles, by turns
inline const reference::Vector kGravity(0.5, -9.81, 1);

inline Scene loose_scene(std::uint32_t substeps) {
  Scene scene = without_contacts();
  scene.solver.substeps = substeps;
  return scene;
}

inline FrameInput falling(std::uint32_t substeps) {
  FrameInput input = frame_of(substeps);
  input.gravity = {static_cast<float>(kGravity.x()), static_cast<float>(kGravity.y()), static_cast<float>(kGravity.z())};
  return input;
}

// Iterates a few centimetres from where the particles were.
inline std::vector<gpu::vec4> moved(Random& random, const CookedFabric& fabric, double size) {
  std::vector<gpu::vec4> p;
  for (const gpu::vec4& x : fabric.positions) {
    const gpu::vec4 d = x.w == 0 ? gpu::vec4{0, 0, 0, 0} : anywhere(random, size, 0);
    p.push_back({x.x + d.x, x.y + d.y, x.z + d.z, x.w});
  }
  return p;
}

// The velocities that lead to these iterates: what predict leaves behind.
inline std::vector<gpu::vec4> leading_to(const std::vector<gpu::vec4>& p, const CookedFabric& fabric) {
  std::vector<gpu::vec4> v;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto speed = reference::velocity(vector(fabric.positions[i]), vector(p[i]), fabric.h);
    v.push_back({static_cast<float>(speed.x()), static_cast<float>(speed.y()), static_cast<float>(speed.z()), fabric.velocities[i].w});
  }
  return v;
}

class SinglePass {
 public:
  SinglePass(const compute::Device& device, const Scene& scene, const CookedFabric& fabric, bool gather_storage = false,
             std::uint32_t workgroup = 0, std::optional<bool> idle_costs = {})
      : device_(device), cache_(must(compute::PipelineCache::create(device))),
        solver_(must(Solver::create(device, cache_, scene, fabric, {gather_storage, workgroup, {}, 0, idle_costs}))), fabric_(fabric) {}

  template <class T>
  void put(const Buffer& row, const std::vector<T>& values) {
    must(compute::upload(device_, solver_.buffer(row), std::as_bytes(std::span(values))));
  }
  template <class T>
  std::vector<T> get(const Buffer& row, std::size_t count) const {
    std::vector<T> values(count);
    must(compute::read_back(device_, solver_.buffer(row), std::as_writable_bytes(std::span(values))));
    return values;
  }
  std::vector<gpu::vec4> particles(const Buffer& row) const { return get<gpu::vec4>(row, fabric_.positions.size()); }

  /// Where the particles are taken to be by the next pass; w becomes their split mass.
  void put_iterate(std::vector<gpu::vec4> p) {
    for (std::size_t i = 0; i < p.size(); ++i) p[i].w = fabric_.iterate_weights[i];
    put(parity_ == 0 ? buffers::predicted : buffers::next_iterate, p);
  }
  std::vector<gpu::vec4> iterate() const { return particles(parity_ == 0 ? buffers::predicted : buffers::next_iterate); }

  /// Lists a frame; run() then takes dispatches out of it in any order.
  void begin(const FrameInput& input) {
    input_ = input;
    const auto steps = solver_.frame(input);
    steps_.assign(steps.begin(), steps.end());
    must(compute::run_once(device_, "input", [&](VkCommandBuffer commands) {
      compute::Recorder recorder(device_, commands);
      solver_.record_input(recorder, input_);
      recorder.finish();
    }));
  }
  /// Runs the `which`-th dispatch of the frame whose pass has this name.
  void run(std::string_view name, int which = 0) {
    for (Solver::Step step : steps_) {
      const Pass& pass = *solver_.plan().passes[step.pass].pass;
      if (pass.name != name || which-- > 0) continue;
      step.parity = parity_;
      must(compute::run_once(device_, name, [&](VkCommandBuffer commands) {
        compute::Recorder recorder(device_, commands);
        solver_.record_step(recorder, step);
        recorder.finish();
      }));
      if (pass.changes == Changes::iterate) parity_ ^= 1;
      return;
    }
    ADD_FAILURE() << "the frame has no such dispatch of " << name;
  }
  gpu::Counters counters() const { return get<gpu::Counters>(buffers::counters, 1).front(); }
  const Solver& solver() const { return solver_; }

 private:
  const compute::Device& device_;
  compute::PipelineCache cache_;
  Solver solver_;
  const CookedFabric& fabric_;
  FrameInput input_;
  std::vector<Solver::Step> steps_;
  std::uint32_t parity_ = 0;
};

/// The largest distance between what the GPU has and what the twin says, m.
inline double largest_gap(const std::vector<gpu::vec4>& got, const reference::Points& wanted) {
  double gap = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const double here = (vector(got[i]) - wanted[i]).norm();
    gap = std::isfinite(here) ? std::max(gap, here) : INFINITY;
  }
  return gap;
}

}  // namespace weft
