// `weft run`: simulates a scene, and leaves pictures, times, figures and the final mesh in a folder.
//
// The scene is simulated once, which makes pictures, figures and the times of whole frames; then, on a device of its own, its
// middle again with a timestamp pair around every pass. They are apart because timestamps take time themselves, and
// because a software driver that has drawn once gives timestamps that mean nothing (llvmpipe bins them with the tiles). The
// second simulation begins with a snapshot of the first, so that a long run costs little more than itself.
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "compute/part_file.h"
#include "engine/export.h"
#include "engine/reference/intersections.h"
#include "samples/weft/caches.h"
#include "samples/weft/checkpoint.h"
#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/movie.h"
#include "samples/weft/outputs.h"
#include "samples/weft/painter.h"
#include "samples/weft/report.h"
#include "samples/weft/run.h"
#include "samples/weft/subject.h"

namespace weft::command {

namespace {

constexpr VkExtent2D kPictureSize = {1280, 720};

std::string frame_name(std::uint32_t frame) {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%04u.png", frame);
  return name;
}

// How much of a scene is timed pass by pass.
constexpr std::uint32_t kMostTimed = 120;   // frames
constexpr double kLongestTimed = 20;        // s; the frame at which it is over is the last

using Clock = std::chrono::steady_clock;
double milliseconds_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

// The state of a run: how far it is, what it has counted, and what is needed to time its middle.
struct RunState {
  Tally tally;
  std::optional<std::uint32_t> resumed_at;
  std::vector<double> milliseconds;  // wall clock around submitting a frame and waiting for it, of this program's frames
  std::uint32_t timed_from = 0;      // frame
  std::optional<Snapshot> middle;    // at that frame; none where it is the scene's start
  std::optional<double> speed;       // m/s, over the last frame
  std::string also_left;             // ", flag.pc2, flag.mp4": what is whole
};

Result<void> advance(Simulation& simulation, RunState& state) {
  const Clock::time_point start = Clock::now();
  const Result<Advance> advance = simulation.advance(1 / simulation.scene().solver.rate);
  if (!advance) return fail("frame ", state.tally.frames, ": ", advance.why());
  state.milliseconds.push_back(milliseconds_since(start));
  state.tally.clamped += advance->clamped;
  ++state.tally.frames;
  return {};
}

Result<void> advance_and_time_particles(Simulation& simulation, RunState& state) {
  const auto before = simulation.read_positions();
  if (!before) return fail(before.why());
  const double start = simulation.time();
  if (Result<void> done = advance(simulation, state); !done) return done;
  const auto after = simulation.read_positions();
  if (!after) return fail(after.why());
  // A longest advance may leave nothing of a frame.
  if (simulation.time() > start) state.speed = fastest_of(simulation.fabric(), *before, *after, simulation.time() - start);
  return {};
}

// Of the cloths; mesh colliders come after them and are left out.
Result<void> write_mesh(const Simulation& simulation, const std::filesystem::path& file) {
  const CookedFabric& fabric = simulation.fabric();
  auto vertices = simulation.read_vertex_positions();
  if (!vertices) return fail(vertices.why());
  auto normals = simulation.read_vertex_normals();
  if (!normals) return fail(normals.why());
  const auto particles = simulation.read_positions();
  if (!particles) return fail(particles.why());
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
  if (!particles) return fail(particles.why());
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
  if (figures.speed) std::printf("In the last frame no particle was faster than %.3g m/s\n", *figures.speed);
  if (figures.frame) std::printf("A whole frame takes %.3g ms (median), %.3g ms (95 %%)\n", figures.frame->median, figures.frame->p95);
  const char* what = figures.mesh_colliders ? "cloth or a mesh" : "cloth";
  if (const auto& found = figures.intersections; found && found->max == 0) std::printf("Cloth crosses %s in no frame\n", what);
  else if (found)
    std::printf("Cloth crosses %s: %llu pairs of edge and triangle in the worst frame, %llu in the last\n", what,
                static_cast<unsigned long long>(found->max), static_cast<unsigned long long>(found->final));
  for (const std::string& remark : figures.remarks) std::printf("%s\n", remark.c_str());
  if (figures.timed_on_cpu) std::printf("This device has no timestamps: passes were timed on the CPU\n");
  if (figures.clamped_seconds > 0)
    std::printf("%.3g s were not simulated: solver.longest_advance is shorter than a frame\n", figures.clamped_seconds);
  if (figures.counts.non_finite > 0) std::printf("%u times a particle that was not finite was put back\n", figures.counts.non_finite);
}

Result<std::unique_ptr<compute::Device>> open_device(const std::string& name, bool graphics) {
  compute::DeviceChoice choice;
  choice.name = name;
  choice.graphics = graphics;
  return compute::Device::create(choice);
}

// Named after the scene, so that another scene's run in the same folder does not take it away.
std::filesystem::path checkpoint_file(const Scene& scene, const RunOptions& options) {
  return options.out / (file_name(scene.name) + ".snapshot");
}

std::string picture_name(const Scene& scene) { return file_name(scene.name) + ".png"; }
std::string movie_name(const Scene& scene) { return file_name(scene.name) + ".mp4"; }

std::vector<std::string> outputs_of(const Scene& scene, const RunOptions& options) {
  std::vector<std::string> names = {"final.ply", "timings.csv", "report.json"};
  if (options.picture) names.push_back(picture_name(scene));
  if (options.movie) names.insert(names.end(), {movie_name(scene), part_of(movie_name(scene)).string()});
  if (options.checkpoint > 0) names.push_back(checkpoint_file(scene, options).filename().string());
  for (std::uint32_t frame = 0; options.every > 0 && frame < scene.frames; frame += options.every) names.push_back(frame_name(frame));
  return names;
}

// What a run leaves of its frames while it goes.
struct Leavings {
  Painter painter;
  Caches caches;
};

// What follows a frame: crossings are counted, caches get it, a picture is drawn, a checkpoint is written.
Result<void> after_frame(Simulation& simulation, Leavings& leavings, const RunOptions& options, Tally& tally) {
  if (tally.intersections)
    if (Result<void> counted = count(simulation, *tally.intersections); !counted) return counted;
  if (Result<void> added = leavings.caches.add(simulation); !added) return added;
  const std::uint32_t frame = tally.frames - 1;
  if (options.every > 0 && frame % options.every == 0)
    if (Result<void> drawn = leavings.painter.draw(simulation, options.out / frame_name(frame)); !drawn) return drawn;
  if (options.checkpoint == 0 || tally.frames % options.checkpoint != 0) return {};
  return write_checkpoint(checkpoint_file(simulation.scene(), options), simulation, tally);
}

Result<void> simulate(Simulation& simulation, Leavings& leavings, const RunOptions& options, RunState& state) {
  const Scene& scene = simulation.scene();
  state.timed_from = std::max(state.tally.frames, scene.frames > kMostTimed ? (scene.frames - kMostTimed) / 2 : 0);
  Progress progress("simulating " + scene.name, scene.frames);
  progress.step(state.tally.frames);
  while (state.tally.frames < scene.frames && !interrupted()) {
    if (state.tally.frames == state.timed_from && state.timed_from > 0) {
      Result<Snapshot> middle = simulation.save();
      if (!middle) return middle.take_error();
      state.middle = std::move(*middle);
    }
    const bool last = state.tally.frames + 1 == scene.frames;
    if (Result<void> done = last ? advance_and_time_particles(simulation, state) : advance(simulation, state); !done) return done;
    if (Result<void> done = after_frame(simulation, leavings, options, state.tally); !done) return done;
    progress.step();
  }
  if (options.checkpoint == 0 || state.tally.frames == 0 || !interrupted()) return {};
  return write_checkpoint(checkpoint_file(scene, options), simulation, state.tally);
}

// Of the pictures of all frames, those of an earlier run that this one went on with too.
Result<void> make_movie(const Scene& scene, const RunOptions& options) {
  if (!options.movie) return {};
  const std::filesystem::path file = options.out / movie_name(scene);
  if (interrupted()) {
    complain(file.string() + " is not written: the run was interrupted");
    return {};
  }
  std::vector<std::filesystem::path> pictures;
  for (std::uint32_t frame = 0; frame < scene.frames; frame += options.every) pictures.push_back(options.out / frame_name(frame));
  if (pictures.empty()) return {};
  return write_movie(file, pictures, scene.solver.rate / options.every);
}

// Where the run begins: at the scene's start, or at the checkpoint of an earlier run.
Exit begin(Simulation& simulation, const RunOptions& options, RunState& state) {
  const std::filesystem::path file = checkpoint_file(simulation.scene(), options);
  if (options.checkpoint > 0 && !options.farm.fresh && is_there(file)) {
    const Result<Checkpoint> left = load_checkpoint(file, simulation, options.check);
    if (!left) {
      complain(left.error() + "; --fresh begins anew");
      return kBadInput;
    }
    const Tally& tally = left->tally;
    if (tally.frames > simulation.scene().frames) {
      complain(file.string() + ": is of frame " + std::to_string(tally.frames) + ", and the run has " +
               std::to_string(simulation.scene().frames));
      return kBadInput;
    }
    if (const Result<void> restored = simulation.restore(left->snapshot); !restored) return failed(file.string() + ": " + restored.error());
    state.tally = tally;
    state.resumed_at = tally.frames;
    std::printf("Going on after frame %u, where %s was left\n", tally.frames, file.string().c_str());
    return kDone;
  }
  // A scene of no frames is a picture of its rest pose, and normals are made by a frame.
  if (simulation.scene().frames == 0)
    if (const Result<Advance> none = simulation.advance(0); !none) return failed(none.error());
  // The pose the simulation starts from counts too, and is the final one of a scene of no frames.
  if (options.check)
    if (const Result<void> counted = count(simulation, state.tally.intersections.emplace()); !counted) return failed(counted.error());
  return kDone;
}

// Pictures, the final mesh, and all figures but those of passes.
Exit simulate_and_draw(const Scene& scene, const RunOptions& options, Figures& figures, RunState& state) {
  const auto device = open_device(options.device, options.picture);
  if (!device) return failed(device.error());
  const Started started = start(**device, scene, false);
  if (!started.simulation) return started.exit;
  Simulation& simulation = *started.simulation;
  Leavings leavings;
  if (options.picture)
    if (const Exit exit = leavings.painter.create(**device, simulation, kPictureSize); exit != kDone) return exit;

  const CookedFabric& fabric = simulation.fabric();
  std::printf("%s: %s on %s\n", scene.name.c_str(), summary_of(simulation.scene(), fabric).c_str(), (*device)->name().c_str());
  const std::size_t notes_before = fabric.notes.size();
  for (const std::string& note : fabric.notes) std::printf("note: %s\n", note.c_str());
  if (const Exit exit = begin(simulation, options, state); exit != kDone) return exit;
  if (const Exit exit = leavings.caches.open(simulation, options, state.resumed_at); exit != kDone) return exit;
  const std::string crossing = state.resumed_at ? "" : crossing_note(simulation.scene(), fabric);
  if (!crossing.empty()) std::printf("note: %s\n", crossing.c_str());
  std::fflush(stdout);
  if (const Result<void> done = simulate(simulation, leavings, options, state); !done) return failed(done.error());
  for (const std::string& note : std::span(fabric.notes).subspan(notes_before)) std::printf("note: %s\n", note.c_str());

  if (const Result<void> drawn = leavings.painter.draw(simulation, options.out / picture_name(scene)); !drawn)
    return failed(drawn.error());
  if (const Result<void> finished = leavings.caches.finish(); !finished) return failed(finished.error());
  if (const Result<void> made = make_movie(scene, options); !made) return failed(made.error());
  state.also_left = leavings.caches.names();
  if (options.movie && !interrupted()) state.also_left += ", " + movie_name(scene);
  if (const Result<void> written = write_mesh(simulation, options.out / "final.ply"); !written) return failed(written.error());
  Result<Figures> measured = figures_of(simulation);
  if (!measured) return failed(measured.error());
  figures = std::move(*measured);
  figures.frames = state.tally.frames;
  figures.resumed_at = state.resumed_at;
  figures.clamped_seconds = state.tally.clamped;
  figures.intersections = state.tally.intersections;
  figures.speed = state.speed;
  if (!state.milliseconds.empty()) figures.frame = spread_of(state.milliseconds);
  return kDone;
}

Exit time_passes(const Scene& scene, const RunOptions& options, const RunState& state, Figures& figures, PassTimes& times) {
  const auto device = open_device(options.device, false);
  if (!device) return failed(device.error());
  const Started started = start(**device, scene, true);
  if (!started.simulation) return started.exit;
  Simulation& simulation = *started.simulation;
  times = PassTimes(simulation.passes(), state.timed_from);
  figures.timed_on_cpu = simulation.timed_on_cpu();
  if (state.middle)
    if (const Result<void> restored = simulation.restore(*state.middle); !restored) return failed(restored.error());
  const std::uint32_t frames = std::min(kMostTimed, scene.frames - std::min(scene.frames, state.timed_from));
  RunState timed;
  Progress progress("timing passes", frames);
  for (const Clock::time_point start = Clock::now();
       timed.tally.frames < frames && milliseconds_since(start) < 1000 * kLongestTimed && !interrupted();) {
    if (const Result<void> done = advance(simulation, timed); !done) return failed(done.error());
    times.add_frame(simulation.timings());
    progress.step();
  }
  // Times that cannot be read are none, and after the last there is no frame that would say so.
  if ((*device)->is_lost()) return failed((*device)->name() + " was lost (VK_ERROR_DEVICE_LOST) while times of passes were read");
  return kDone;
}

}  // namespace

Exit run(const RunOptions& options) {
  Figures figures;
  return run(options, figures);
}

Exit run(const RunOptions& options, Figures& figures) {
  Result<Scene> scene = load_subject(options.file, options.assignments, options.buffer_files);
  if (!scene) {
    complain(scene.error());
    return kBadInput;
  }
  if (options.frames) scene->frames = *options.frames;
  if (options.movie && !has_ffmpeg()) return failed("--movie: the program ffmpeg, which makes it, is not installed");
  listen_for_interrupts();
  const std::vector<Input> inputs = inputs_of(options.file, *scene);
  if (const Exit exit = prepare_outputs(options.out, outputs_of(*scene, options), inputs); exit != kDone) return exit;
  if (const Exit exit = Caches::prepare(*scene, options, inputs); exit != kDone) return exit;

  PassTimes times({});
  RunState state;
  if (const Exit exit = simulate_and_draw(*scene, options, figures, state); exit != kDone) return exit;
  if (const Exit exit = time_passes(*scene, options, state, figures, times); exit != kDone) return exit;

  figures.interrupted = interrupted();
  if (const Result<void> written = write_text(options.out / "timings.csv", times.csv()); !written) return failed(written.error());
  if (const Result<void> written = write_text(options.out / "report.json", report_json(figures, times)); !written)
    return failed(written.error());
  print(figures, scene->solver.rate);
  std::printf("Written: %stimings.csv, report.json, final.ply%s in %s\n", options.picture ? (picture_name(*scene) + ", ").c_str() : "",
              state.also_left.c_str(), options.out.string().c_str());
  if (!interrupted()) {
    // A run that is over is not gone on with.
    std::error_code ignored;
    if (options.checkpoint > 0) std::filesystem::remove(checkpoint_file(*scene, options), ignored);
    return kDone;
  }
  return stopped(" after " + std::to_string(figures.frames) + " of " + std::to_string(scene->frames) + " frames, " +
                 std::to_string(times.frames()) + " of them timed pass by pass: what is written is of these" +
                 (options.checkpoint > 0 ? "; the same command goes on from here" : "; without --checkpoint the same command begins anew"));
}

}  // namespace weft::command
