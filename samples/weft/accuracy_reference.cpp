// Runs references, and saves them: a few head and then all coordinates in double precision, as the machine has them.
#include "samples/weft/accuracy_reference.h"

#include <cmath>
#include <fstream>

#include "engine/scene/origin.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"

namespace weft::command {

namespace {

using reference::Trajectory;

struct FileHead {
  std::uint64_t frames = 0, particles = 0, not_converged = 0, newton_steps = 0;
};

bool read(const std::filesystem::path& file, std::uint32_t frames, std::size_t particles, Trajectory& run) {
  std::ifstream stream(file, std::ios::binary);
  FileHead head;
  if (!stream.read(reinterpret_cast<char*>(&head), sizeof head) || head.frames != frames || head.particles != particles)
    return false;
  run.not_converged = head.not_converged;
  run.newton_steps = head.newton_steps;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    reference::Positions& pose = run.poses.emplace_back(3, static_cast<Eigen::Index>(particles));
    stream.read(reinterpret_cast<char*>(pose.data()), static_cast<std::streamsize>(sizeof(double) * static_cast<std::size_t>(pose.size())));
  }
  return static_cast<bool>(stream);
}

std::string bytes_of(const Trajectory& run) {
  const FileHead head{run.poses.size(), run.poses.empty() ? 0 : static_cast<std::uint64_t>(run.poses[0].cols()), run.not_converged,
                      run.newton_steps};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  for (const reference::Positions& pose : run.poses)
    bytes.append(reinterpret_cast<const char*>(pose.data()), sizeof(double) * static_cast<std::size_t>(pose.size()));
  return bytes;
}

// What the reference solves, apart from its step.
std::string fingerprint(const Scene& scene, const CookedFabric& fabric) {
  Fingerprint print;
  print.add(scene_text(scene));
  for (const StretchLink& link : fabric.links) {
    const gpu::uvec4 bits{link.a, link.b, WEFT_BITS(link.rest), WEFT_BITS(link.compliance)};   // no padding, no gain
    print.add(&bits, sizeof bits);
  }
  if (!fabric.bends.empty()) print.add(fabric.bends.data(), fabric.bends.size() * sizeof fabric.bends[0]);
  if (!fabric.hinges.empty()) print.add(fabric.hinges.data(), fabric.hinges.size() * sizeof fabric.hinges[0]);
  if (!fabric.tethers.empty()) print.add(fabric.tethers.data(), fabric.tethers.size() * sizeof fabric.tethers[0]);
  return print.text();
}

}  // namespace

Result<Trajectory> reference_run(Scene scene, std::uint32_t substeps, std::uint32_t frames, const std::filesystem::path& folder) {
  const double rate = scene.solver.rate;
  scene.solver = {};   // the reference uses the time step alone
  scene.solver.rate = rate;
  scene.solver.substeps = substeps;
  scene.frames = frames;
  auto near = recentred(scene);   // as a simulation does
  if (!near) return near.take_error();
  scene = std::move(near->scene);
  auto fabric = cook(scene, near->meshes);
  if (!fabric) return fabric.take_error();

  Trajectory run;
  const std::filesystem::path file = folder / ("reference-" + fingerprint(scene, *fabric) + ".bin");
  if (read(file, frames, fabric->positions.size(), run)) {
    run.frame_seconds = 1 / rate;
    return run;
  }
  const std::uint32_t steps = frames * substeps;
  Progress progress("reference of " + std::to_string(substeps) + " steps a frame", steps, "steps");
  reference::NewtonSettings settings;
  settings.h = fabric->h;
  std::uint32_t done = 0;
  auto solved = reference::integrate_newton(scene, *fabric, frames, settings, [&](double part) {
    const auto now = static_cast<std::uint32_t>(std::lround(part * steps));
    if (now > done) progress.step(now - done);
    done = std::max(done, now);
    return !interrupted();
  });
  if (!solved) return solved;
  if (auto written = write_text(file, bytes_of(*solved)); !written) return written.take_error();
  return solved;
}

}  // namespace weft::command
