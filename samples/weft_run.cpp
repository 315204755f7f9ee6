// `weft run`: simulates a scene, and leaves pictures, times, figures and the final mesh in a folder.
//
// Two runs: the first with a timestamp pair around every pass, for timings.csv, pictures and the final state; then some
// frames without, for the times of whole frames, which the timestamps would otherwise be part of.
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "engine/export.h"
#include "engine/shading/shading.h"
#include "samples/commands.h"
#include "samples/console.h"
#include "samples/files.h"
#include "samples/report.h"
#include "samples/subject.h"

namespace weft::command {

namespace {

constexpr VkExtent2D kPictureSize = {1280, 720};
constexpr std::uint32_t kWholeFrames = 120;  // enough for a median; a long scene need not run twice

Exit failed(const std::string& sentence) {
  complain(sentence);
  return kFailed;
}

// Draws a simulation's frames; without a picture to draw it does nothing.
class Painter {
 public:
  Exit create(compute::Device& device, const Simulation& simulation) {
    const Scene& scene = simulation.scene();
    std::vector<ShadedCloth> cloths;
    for (std::size_t i = 0; i < scene.cloths.size(); ++i)
      cloths.push_back({&simulation.meshes()[i].render, &scene.cloths[i].appearance});
    auto shading = Shading::create(device, scene, cloths, kPictureSize);
    if (shading) {
      shading_ = std::move(*shading);
      return kDone;
    }
    const std::vector<std::string> faults = file_faults(scene);
    for (const std::string& fault : faults) complain(fault);
    return faults.empty() ? failed(shading.error()) : kBadInput;
  }

  Result<void> draw(const Simulation& simulation, const std::filesystem::path& file) {
    if (!shading_) return {};
    const Result<Image> image = shading_->draw({simulation.positions(), simulation.normals(), simulation.colliders()});
    if (!image) return fail(image.error());
    return write_png(file, *image);
  }

 private:
  std::unique_ptr<Shading> shading_;
};

std::string frame_name(std::uint32_t frame) {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%04u.png", frame);
  return name;
}

struct Frames {
  std::uint32_t done = 0;
  double clamped = 0;  // s
};

Result<Frames> simulate(Simulation& simulation, Painter& painter, PassTimes& times, const RunOptions& options) {
  const Scene& scene = simulation.scene();
  Frames frames;
  // A scene of no frames is a picture of its rest pose; its normals are still wanted.
  if (scene.frames == 0)
    if (const Result<Advance> none = simulation.advance(0); !none) return fail(none.error());
  Progress progress("simulating " + scene.name, scene.frames);
  for (std::uint32_t frame = 0; frame < scene.frames && !interrupted(); ++frame) {
    const Result<Advance> advance = simulation.advance(1 / scene.solver.rate);
    if (!advance) return fail("frame ", frame, ": ", advance.error());
    frames.clamped += advance->clamped;
    times.add_frame(simulation.timings());
    if (options.every > 0 && frame % options.every == 0)
      if (Result<void> drawn = painter.draw(simulation, options.out / frame_name(frame)); !drawn) return drawn.take_error();
    ++frames.done;
    progress.step();
  }
  return frames;
}

// The wall clock around submitting a frame and waiting for it.
Result<std::optional<Spread>> time_whole_frames(Simulation& simulation) {
  using Clock = std::chrono::steady_clock;
  const std::uint32_t count = std::min(simulation.scene().frames, kWholeFrames);
  Progress progress("timing whole frames", count);
  std::vector<double> milliseconds;
  for (std::uint32_t frame = 0; frame < count; ++frame) {
    if (interrupted()) return std::optional<Spread>();
    const Clock::time_point start = Clock::now();
    const Result<Advance> advance = simulation.advance(1 / simulation.scene().solver.rate);
    if (!advance) return fail("frame ", frame, ": ", advance.error());
    milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    progress.step();
  }
  if (milliseconds.empty()) return std::optional<Spread>();
  return std::optional<Spread>(spread_of(std::move(milliseconds)));
}

Result<void> write_mesh(const Simulation& simulation, const std::filesystem::path& file) {
  const auto vertices = simulation.read_vertex_positions();
  if (!vertices) return fail(vertices.error());
  const auto normals = simulation.read_vertex_normals();
  if (!normals) return fail(normals.error());
  const auto particles = simulation.read_positions();
  if (!particles) return fail(particles.error());
  std::vector<Triangle> triangles;
  std::uint32_t first = 0;
  for (const Mesh& mesh : simulation.meshes()) {
    for (const Triangle& t : mesh.render.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    first += static_cast<std::uint32_t>(mesh.render.positions.size());
  }
  return write_ply(file, *vertices, *normals, vertex_strain(simulation.fabric(), *particles), triangles);
}

void print(const Figures& figures, double rate) {
  std::printf("%u frames, %.3g s; strain: mean %.3g %%, rms %.3g %%, max %.3g %%\n", figures.frames, figures.frames / rate,
              100 * figures.strain.mean, 100 * figures.strain.rms, 100 * figures.strain.max);
  if (figures.frame) std::printf("A whole frame takes %.3g ms (median), %.3g ms (95 %%)\n", figures.frame->median, figures.frame->p95);
  if (figures.timed_on_cpu) std::printf("This device has no timestamps: passes were timed on the CPU\n");
  if (figures.clamped_seconds > 0)
    std::printf("%.3g s were not simulated: solver.longest_advance is shorter than a frame\n", figures.clamped_seconds);
  if (figures.counts.non_finite > 0) std::printf("%u times a particle that was not finite was put back\n", figures.counts.non_finite);
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

  compute::DeviceChoice choice;
  choice.name = options.device;
  choice.graphics = options.picture;
  const auto device = compute::Device::create(choice);
  if (!device) return failed(device.error());
  Started started = start(**device, *scene, true);
  if (!started.simulation) return started.exit;
  Simulation& simulation = *started.simulation;
  Painter painter;
  if (options.picture)
    if (const Exit exit = painter.create(**device, simulation); exit != kDone) return exit;
  std::printf("%s: %zu particles, %zu edges, %zu bends, %llu tethers on %s\n", scene->name.c_str(), simulation.fabric().positions.size(),
              simulation.fabric().links.size(), simulation.fabric().bends.size(),
              static_cast<unsigned long long>(simulation.fabric().tether_count), (*device)->name().c_str());
  for (const std::string& note : simulation.fabric().notes) std::printf("note: %s\n", note.c_str());
  std::fflush(stdout);

  listen_for_interrupts();
  PassTimes times(simulation.passes());
  const Result<Frames> frames = simulate(simulation, painter, times, options);
  if (!frames) return failed(frames.error());

  Result<Figures> figures = figures_of(simulation);
  if (!figures) return failed(figures.error());
  const std::filesystem::path picture = options.out / (file_name(scene->name) + ".png");
  if (const Result<void> drawn = painter.draw(simulation, picture); !drawn) return failed(drawn.error());
  if (const Result<void> written = write_mesh(simulation, options.out / "final.ply"); !written) return failed(written.error());
  if (const Result<void> written = write_text(options.out / "timings.csv", times.csv()); !written) return failed(written.error());

  if (!interrupted()) {
    const Started again = start(**device, *scene, false);
    if (!again.simulation) return again.exit;
    const auto whole = time_whole_frames(*again.simulation);
    if (!whole) return failed(whole.error());
    figures->frame = *whole;
  }
  figures->frames = frames->done;
  figures->clamped_seconds = frames->clamped;
  figures->interrupted = interrupted();
  if (const Result<void> written = write_text(options.out / "report.json", report_json(*figures, times)); !written) return failed(written.error());

  print(*figures, scene->solver.rate);
  std::printf("Written: %s%s in %s\n", options.picture ? (picture.filename().string() + ", ").c_str() : "", "timings.csv, report.json, final.ply",
              options.out.string().c_str());
  if (!interrupted()) return kDone;
  complain("Interrupted after " + std::to_string(frames->done) + " of " + std::to_string(scene->frames) + " frames: what is written is of these");
  return kInterrupted;
}

}  // namespace weft::command
