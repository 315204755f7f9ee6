// `weft run`: simulates a scene, and leaves pictures, times, figures and the final mesh in a folder.
//
// The scene is simulated twice. The first time makes pictures, figures and the times of whole frames; the second, on a
// device of its own, has a timestamp pair around every pass. They are apart because timestamps take time themselves, and
// because a software driver that has drawn once gives timestamps that mean nothing (llvmpipe bins them with the tiles).
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "engine/export.h"
#include "engine/reference/intersections.h"
#include "samples/commands.h"
#include "samples/console.h"
#include "samples/files.h"
#include "samples/painter.h"
#include "samples/report.h"
#include "samples/subject.h"

namespace weft::command {

namespace {

constexpr VkExtent2D kPictureSize = {1280, 720};

std::string frame_name(std::uint32_t frame) {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%04u.png", frame);
  return name;
}

struct Frames {
  std::vector<double> milliseconds;  // wall clock around submitting a frame and waiting for it
  double clamped = 0;                // s
};

// Calls `each` after every frame, until it fails or ctrl-C.
template <class F>
Result<Frames> simulate(Simulation& simulation, const std::string& what, F&& each) {
  using Clock = std::chrono::steady_clock;
  const Scene& scene = simulation.scene();
  Frames frames;
  Progress progress(what, scene.frames);
  for (std::uint32_t frame = 0; frame < scene.frames && !interrupted(); ++frame) {
    const Clock::time_point start = Clock::now();
    const Result<Advance> advance = simulation.advance(1 / scene.solver.rate);
    if (!advance) return fail("frame ", frame, ": ", advance.error());
    frames.milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    frames.clamped += advance->clamped;
    if (Result<void> done = each(frame); !done) return done.take_error();
    progress.step();
  }
  return frames;
}

// Of the cloths; mesh colliders come after them and are left out.
Result<void> write_mesh(const Simulation& simulation, const std::filesystem::path& file) {
  const CookedFabric& fabric = simulation.fabric();
  auto vertices = simulation.read_vertex_positions();
  if (!vertices) return fail(vertices.error());
  auto normals = simulation.read_vertex_normals();
  if (!normals) return fail(normals.error());
  const auto particles = simulation.read_positions();
  if (!particles) return fail(particles.error());
  std::vector<Triangle> triangles;
  std::uint32_t first = 0;
  for (const Mesh& mesh : std::span(simulation.meshes()).first(fabric.cloths.size())) {
    for (const Triangle& t : mesh.render.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    first += static_cast<std::uint32_t>(mesh.render.positions.size());
  }
  std::vector<float> strain = vertex_strain(fabric, *particles);
  vertices->resize(first);
  normals->resize(first);
  strain.resize(first);
  return write_ply(file, *vertices, *normals, strain, triangles);
}

Result<void> count(const Simulation& simulation, Intersections& intersections) {
  const auto particles = simulation.read_positions();
  if (!particles) return fail(particles.error());
  std::vector<Vec3> positions;
  positions.reserve(particles->size());
  for (const gpu::vec4& particle : *particles) positions.push_back({particle.x, particle.y, particle.z});
  intersections.final = count_crossings(positions, simulation.fabric().triangles, simulation.fabric().cloth_triangles);
  intersections.max = std::max(intersections.max, intersections.final);
  return {};
}

void print(const Figures& figures, double rate) {
  std::printf("%u frames, %.3g s; strain: mean %.3g %%, rms %.3g %%, max %.3g %%\n", figures.frames, figures.frames / rate,
              100 * figures.strain.mean, 100 * figures.strain.rms, 100 * figures.strain.max);
  if (figures.frame) std::printf("A whole frame takes %.3g ms (median), %.3g ms (95 %%)\n", figures.frame->median, figures.frame->p95);
  const char* what = figures.mesh_colliders ? "cloth or a mesh" : "cloth";
  if (const auto& found = figures.intersections; found && found->max == 0) std::printf("Cloth crosses %s in no frame\n", what);
  else if (found)
    std::printf("Cloth crosses %s: %llu pairs of edge and triangle in the worst frame, %llu in the last\n", what,
                static_cast<unsigned long long>(found->max), static_cast<unsigned long long>(found->final));
  if (const Counts& counts = figures.counts; figures.implicit && counts.unconverged > 0)
    std::printf("%u substeps were solved to worse than 1 %% (the last to %.2g %%): more iterations or shorter substeps do better\n", counts.unconverged,
                100 * counts.residual);
  if (const Counts& counts = figures.counts; figures.contacts) {
    std::printf("Contacts: up to %u pairs, searched for %u times; %u times a particle was stopped short\n", counts.contacts_most, counts.detections,
                counts.truncated);
    if (counts.contacts_lost > 0) std::printf("%u pairs found no room: their particles were held still instead\n", counts.contacts_lost);
  }
  if (figures.timed_on_cpu) std::printf("This device has no timestamps: passes were timed on the CPU\n");
  if (figures.clamped_seconds > 0)
    std::printf("%.3g s were not simulated: solver.longest_advance is shorter than a frame\n", figures.clamped_seconds);
  if (figures.chebyshev) std::printf("%u substeps were finished without acceleration\n", figures.counts.unaccelerated);
  if (figures.counts.non_finite > 0) std::printf("%u times a particle that was not finite was put back\n", figures.counts.non_finite);
}

Result<std::unique_ptr<compute::Device>> open_device(const std::string& name, bool graphics) {
  compute::DeviceChoice choice;
  choice.name = name;
  choice.graphics = graphics;
  return compute::Device::create(choice);
}

// Pictures, the final mesh, and all figures but those of passes.
Exit simulate_and_draw(const Scene& scene, const RunOptions& options, Figures& figures) {
  const auto device = open_device(options.device, options.picture);
  if (!device) return failed(device.error());
  const Started started = start(**device, scene, false);
  if (!started.simulation) return started.exit;
  Simulation& simulation = *started.simulation;
  Painter painter;
  if (options.picture)
    if (const Exit exit = painter.create(**device, simulation, kPictureSize); exit != kDone) return exit;

  const CookedFabric& fabric = simulation.fabric();
  std::printf("%s: %zu particles, %zu edges, %zu bends, %llu tethers on %s\n", scene.name.c_str(), std::size_t(cloth_particles(fabric)), fabric.links.size(),
              fabric.bends.size(), static_cast<unsigned long long>(fabric.tether_count), (*device)->name().c_str());
  for (const std::string& note : fabric.notes) std::printf("note: %s\n", note.c_str());
  std::fflush(stdout);

  // A scene of no frames is a picture of its rest pose, and normals are made by a frame.
  if (scene.frames == 0)
    if (const Result<Advance> none = simulation.advance(0); !none) return failed(none.error());
  std::optional<Intersections> intersections;
  if (options.check) {
    // The pose the simulation starts from counts too, and is the final one of a scene of no frames.
    if (const Result<void> counted = count(simulation, intersections.emplace()); !counted) return failed(counted.error());
  }
  const Result<Frames> frames = simulate(simulation, "simulating " + scene.name, [&](std::uint32_t frame) -> Result<void> {
    if (intersections)
      if (Result<void> counted = count(simulation, *intersections); !counted) return counted;
    if (options.every == 0 || frame % options.every != 0) return {};
    return painter.draw(simulation, options.out / frame_name(frame));
  });
  if (!frames) return failed(frames.error());

  if (const Result<void> drawn = painter.draw(simulation, options.out / (file_name(scene.name) + ".png")); !drawn) return failed(drawn.error());
  if (const Result<void> written = write_mesh(simulation, options.out / "final.ply"); !written) return failed(written.error());
  Result<Figures> measured = figures_of(simulation);
  if (!measured) return failed(measured.error());
  figures = std::move(*measured);
  figures.frames = static_cast<std::uint32_t>(frames->milliseconds.size());
  figures.clamped_seconds = frames->clamped;
  figures.intersections = intersections;
  if (!frames->milliseconds.empty()) figures.frame = spread_of(frames->milliseconds);
  return kDone;
}

Exit time_passes(const Scene& scene, const RunOptions& options, Figures& figures, PassTimes& times) {
  const auto device = open_device(options.device, false);
  if (!device) return failed(device.error());
  const Started started = start(**device, scene, true);
  if (!started.simulation) return started.exit;
  Simulation& simulation = *started.simulation;
  times = PassTimes(simulation.passes());
  figures.timed_on_cpu = simulation.timed_on_cpu();
  const Result<Frames> frames = simulate(simulation, "timing passes", [&](std::uint32_t) -> Result<void> {
    times.add_frame(simulation.timings());
    return {};
  });
  return frames ? kDone : failed(frames.error());
}

}  // namespace

Exit run(const RunOptions& options) {
  Result<Scene> scene = load_subject(options.file, options.assignments);
  if (!scene) {
    complain(scene.error());
    return kBadInput;
  }
  if (options.frames) scene->frames = *options.frames;
  if (const Result<void> made = make_folder(options.out); !made) return failed(made.error());

  listen_for_interrupts();
  Figures figures;
  PassTimes times({});
  if (const Exit exit = simulate_and_draw(*scene, options, figures); exit != kDone) return exit;
  if (const Exit exit = time_passes(*scene, options, figures, times); exit != kDone) return exit;

  figures.interrupted = interrupted();
  if (const Result<void> written = write_text(options.out / "timings.csv", times.csv()); !written) return failed(written.error());
  if (const Result<void> written = write_text(options.out / "report.json", report_json(figures, times)); !written) return failed(written.error());
  print(figures, scene->solver.rate);
  std::printf("Written: %stimings.csv, report.json, final.ply in %s\n", options.picture ? (file_name(scene->name) + ".png, ").c_str() : "",
              options.out.string().c_str());
  if (!interrupted()) return kDone;
  complain("Interrupted after " + std::to_string(figures.frames) + " of " + std::to_string(scene->frames) + " frames, " +
           std::to_string(times.frames()) + " of them timed pass by pass: what is written is of these");
  return kInterrupted;
}

}  // namespace weft::command
