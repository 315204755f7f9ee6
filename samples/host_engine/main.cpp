// A miniature game engine with cloth in it: how Weft lives inside somebody else's program.
//
// The engine owns the instance, the device, the queue, the command buffers and the renderer, and lends the first three to
// Weft. Its clock is its own: a frame is 1/60 s of the game, however long it took. It shows, one after the other:
//
//   recorded   Weft records its frame into the engine's command buffer, which then draws: one submit, no semaphore
//   submitted  Weft submits its frame by itself. The draw waits for Weft on the GPU, and Weft's next frame for the draw
//
//                Weft    simulate 1 ------+  simulate 2 ------+
//                                  ready 1 \   ^ drawn 1       \ ready 2
//                engine                     draw 1 ----         draw 2 ----
//
//   without    Weft is destroyed; the engine goes on
//   again      Weft is created once more, where the curtain should be by now
//
// In every frame the engine moves the anchors and a collider, and draws from Weft's buffers: no vertex is copied.
#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdio>
#include <optional>

#include "engine/simulation.h"
#include "samples/host_engine/assets.h"
#include "samples/host_engine/frames.h"
#include "samples/host_engine/world.h"

namespace host {
namespace {

constexpr double kFrame = 1.0 / 60;   // s of the game
constexpr VkExtent2D kSize{960, 540};

struct Options {
  std::uint32_t frames = 240;
  std::string device;
  std::filesystem::path out = "out/host_engine.png";
  bool validation = false;
};

/// Everything of Weft's, and the one thing that the engine adds: what order to draw the vertices in.
struct Cloth {
  std::unique_ptr<weft::compute::Device> device;   // the engine's, borrowed
  std::unique_ptr<weft::Simulation> simulation;
  Buffer indices;
  std::uint32_t index_count = 0;
  Vec3 beam;                                        // where the anchors' rest places belong to
};

class Engine {
 public:
  static Result<std::unique_ptr<Engine>> create(const DeviceRequest& request);
  Result<void> run(const Options& options);

 private:
  enum class Way { record, submit, without };
  struct Act {
    const char* title;
    Way way;
    std::uint32_t first, end;   // frames
  };

  Engine() = default;
  Result<void> play(const Act& act);
  Result<void> start_weft();
  Result<void> stop_weft();
  Result<void> move_things();
  Result<void> frame(Way way);
  void draw(VkCommandBuffer commands) const;
  Result<void> save(const std::filesystem::path& file);

  // Destroyed from the last to the first.
  std::unique_ptr<Device> device_;
  std::unique_ptr<Renderer> renderer_;
  Model sphere_, box_;
  std::optional<Cloth> cloth_;
  std::unique_ptr<Frames> frames_;   // waits for all drawing, so before everything that is drawn
  double time_ = 0;                  // s on the game's clock
};

Result<std::unique_ptr<Engine>> Engine::create(const DeviceRequest& request) {
  std::unique_ptr<Engine> engine(new Engine);
  auto device = Device::create(request);
  if (!device) return device.take_error();
  engine->device_ = std::move(*device);
  auto renderer = Renderer::create(*engine->device_, kSize);
  if (!renderer) return renderer.take_error();
  engine->renderer_ = std::move(*renderer);
  auto ball = Model::create(*engine->device_, sphere()), cube = Model::create(*engine->device_, box());
  if (!ball || !cube) return ball ? cube.take_error() : ball.take_error();
  engine->sphere_ = std::move(*ball);
  engine->box_ = std::move(*cube);
  auto frames = Frames::create(*engine->device_);
  if (!frames) return frames.take_error();
  engine->frames_ = std::move(*frames);
  return engine;
}

Result<void> Engine::run(const Options& options) {
  std::printf("host_engine: %u frames of %u x %u on %s\n", options.frames, kSize.width, kSize.height, device_->name().c_str());
  const auto part = [&](std::uint32_t twentieths) { return options.frames * twentieths / 20; };
  const Act acts[] = {
      {"recorded into the engine's command buffer", Way::record, 0, part(7)},
      {"submitted by Weft, timeline semaphores between", Way::submit, part(7), part(12)},
      {"without Weft: destroyed, the engine goes on", Way::without, part(12), part(14)},
      {"created again, submitted by Weft", Way::submit, part(14), options.frames},
  };
  for (const Act& act : acts)
    if (auto done = play(act); !done) return done;
  std::printf("  Every frame with Weft moved its anchors and the ball, and was drawn from Weft's buffers: no vertex was copied.\n");
  if (auto done = save(options.out); !done) return done;
  return stop_weft();
}

Result<void> Engine::play(const Act& act) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const auto start = Clock::now();
  if (act.way == Way::without) {
    if (auto done = stop_weft(); !done) return done;
  } else if (!cloth_) {
    if (auto done = start_weft(); !done) return done;
    std::printf("  Weft created in %.0f ms: %u vertices, %zu anchors\n", 1e3 * since(start), cloth_->simulation->positions().count,
                cloth_->simulation->fabric().anchors.size());
  }
  const auto first = Clock::now();
  for (std::uint32_t k = act.first; k < act.end; ++k)
    if (auto done = frame(act.way); !done) return fail("frame ", k, ": ", done.why());
  if (auto done = frames_->wait(); !done) return done;
  std::printf("  frames %3u to %3u: %-47s %7.1f frames/s\n", act.first, act.end - 1, act.title, (act.end - act.first) / since(first));
  return {};
}

Result<void> Engine::start_weft() {
  Cloth cloth;
  auto borrowed = weft::compute::Device::borrow(device_->lend());
  if (!borrowed) return borrowed.take_error();
  cloth.device = std::move(*borrowed);
  // Only draws read Weft's buffers: the engine's fragment shaders and its other commands hold up no simulation.
  weft::SimulationOptions options;
  options.readers = {VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT, VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT};
  auto simulation = weft::Simulation::create(*cloth.device, cloth_scene(time_), options);
  if (!simulation) return simulation.take_error();
  cloth.simulation = std::move(*simulation);
  const weft::FrameView view = cloth.simulation->positions(), drawable;
  if (view.stride != drawable.stride || view.format != drawable.format)
    return fail("Weft's vertices are not in the format that the renderer draws");
  const auto& triangles = cloth.simulation->meshes()[0].render.triangles;
  auto indices = create_indices(*device_, triangles);
  if (!indices) return indices.take_error();
  cloth.indices = std::move(*indices);
  cloth.index_count = static_cast<std::uint32_t>(3 * triangles.size());
  cloth.beam = beam(time_);
  cloth_ = std::move(cloth);
  return {};
}

Result<void> Engine::stop_weft() {
  // Weft waits for what it submitted itself; the engine for what it recorded, and for draws that read Weft's buffers.
  if (auto done = frames_->wait(); !done) return done;
  cloth_.reset();
  return {};
}

Result<void> Engine::move_things() {
  std::vector<Vec3> targets;
  // What is cooked is told from the simulation's origin; targets are in the world.
  const Vec3 moved = cloth_->simulation->origin() + beam(time_) - cloth_->beam;
  for (const weft::AnchorTarget& anchor : cloth_->simulation->fabric().anchors) targets.push_back(anchor.rest + moved);
  if (auto done = cloth_->simulation->move_anchors(0, targets); !done) return done;
  return cloth_->simulation->move_collider(kBall, {.centre = ball(time_)});
}

Result<void> Engine::frame(Way way) {
  time_ += kFrame;
  if (way == Way::without) {
    auto commands = frames_->begin();
    if (!commands) return commands.take_error();
    draw(*commands);
    return frames_->end();
  }

  if (auto done = move_things(); !done) return done;
  weft::Simulation& simulation = *cloth_->simulation;
  if (way == Way::record) {
    auto commands = frames_->begin();
    if (!commands) return commands.take_error();
    if (auto simulated = simulation.record(*commands, kFrame); !simulated) return simulated.take_error();
    draw(*commands);
    return frames_->end();
  }

  const VkSemaphoreSubmitInfo drawn = frames_->drawn();
  if (auto simulated = simulation.submit(kFrame, {&drawn, 1}); !simulated) return simulated.take_error();
  auto commands = frames_->begin();
  if (!commands) return commands.take_error();
  draw(*commands);
  auto ready = typed<VkSemaphoreSubmitInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO);
  ready.semaphore = simulation.ready_semaphore();
  ready.value = simulation.ready_value();
  ready.stageMask = VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT;
  return frames_->end({&ready, 1});
}

void Engine::draw(VkCommandBuffer commands) const {
  const Stage stage{.eye = {1.5f, 1.5f, 2.9f}, .target = {0.02f, 0.98f, 0}, .sun = {-0.85f, -1, -0.3f}};
  std::vector<Drawable> drawables;
  Drawable& floor = drawables.emplace_back(box_.drawable());
  floor.scale = {60, 0.02f, 60};
  floor.place = {0, -0.01f, 0};
  floor.colour = {0.42f, 0.40f, 0.37f};
  floor.casts = false;
  Drawable& rod = drawables.emplace_back(box_.drawable());
  rod.scale = kBeamSize;
  rod.place = beam(time_) + Vec3{0, kBeamSize.y / 2, 0};
  rod.colour = {0.30f, 0.19f, 0.11f};
  Drawable& globe = drawables.emplace_back(sphere_.drawable());
  globe.scale = {kBallRadius, kBallRadius, kBallRadius};
  globe.place = ball(time_);
  globe.colour = {0.82f, 0.62f, 0.18f};
  if (cloth_) {
    Drawable& curtain = drawables.emplace_back();
    curtain.positions = cloth_->simulation->positions();
    curtain.normals = cloth_->simulation->normals();
    curtain.indices = cloth_->indices.handle();
    curtain.index_count = cloth_->index_count;
    curtain.colour = {0.62f, 0.09f, 0.12f};
  }
  renderer_->draw(commands, stage, drawables);
}

Result<void> Engine::save(const std::filesystem::path& file) {
  auto commands = frames_->begin();
  if (!commands) return commands.take_error();
  renderer_->read_back(*commands);
  if (auto done = frames_->end(); !done) return done;
  if (auto done = frames_->wait(); !done) return done;
  if (auto done = write_png(file, renderer_->size(), renderer_->pixels()); !done) return done;
  std::printf("  The last frame is %s\n", file.string().c_str());
  return {};
}

int run(const Options& options) {
  Complaints complaints;   // outlives the device, whose end validation also watches
  {
    auto engine = Engine::create({options.device, options.validation ? &complaints : nullptr});
    auto done = engine ? (*engine)->run(options) : Result<void>(engine.take_error());
    if (!done) {
      std::fprintf(stderr, "host_engine: %s\n", done.error().c_str());
      return 1;
    }
  }
  if (complaints.count > 0) {
    std::fprintf(stderr, "host_engine: validation complained %u times\n", complaints.count.load());
    return 1;
  }
  if (options.validation) std::printf("  Validation had nothing to say\n");
  return 0;
}

}  // namespace
}  // namespace host

int main(int count, char** words) {
  host::Options options;
  CLI::App app("A miniature game engine that embeds Weft: records it, submits it, destroys it, creates it again.");
  app.add_option("--frames", options.frames, "How many frames, 20 to 100000")->check(CLI::Range(20, 100000))->capture_default_str();
  app.add_option("--device", options.device, "A Vulkan device's index, or part of its name");
  app.add_option("--out", options.out, "Where the last frame goes, as a PNG")->capture_default_str();
  app.add_flag("--validation", options.validation, "Khronos and synchronization validation; a message makes the exit code 1");
  try {
    app.parse(count, words);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);   // --help
    std::fprintf(stderr, "host_engine: %s (host_engine --help tells what there is)\n", error.what());
    return 2;
  }
  return host::run(options);
}
