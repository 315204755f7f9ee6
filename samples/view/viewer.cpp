// See samples/view/viewer.h.
#include "samples/view/viewer.h"

#include <vulkan/vulkan.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "samples/weft/console.h"

namespace weft::view {
namespace {

// A picture that takes longer than the simulation, and longer than this, is drawn smaller and stretched.
constexpr double kDrawing = 33;   // ms
// A picture that stands still is drawn as fine as this allows.
constexpr double kDrawingAtRest = 250;   // ms
constexpr double kRest = 0.3;            // s
constexpr std::array kScales = {1.0, 0.75, 0.5, 0.35, 0.25};
constexpr std::size_t kMostFaults = 8;
// Copied to and from; its view, which every image here has, takes one more.
constexpr VkImageUsageFlags kCopied =
    VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;

// Of the last thousand, so that a viewer that is left alone does not grow.
void add(std::vector<double>& times, double time) {
  if (times.size() >= 1000) times.erase(times.begin());
  times.push_back(time);
}

double median(std::vector<double> times) {
  if (times.empty()) return 0;
  std::ranges::nth_element(times, times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2));
  return times[times.size() / 2];
}

// As compute's, for every kind of copy: clears and blits, too.
constexpr compute::ImageUse kWritten{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                     VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr compute::ImageUse kRead{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                  VK_ACCESS_2_TRANSFER_READ_BIT};

bool are_same(VkExtent2D a, VkExtent2D b) { return a.width == b.width && a.height == b.height; }

double milliseconds(std::chrono::steady_clock::duration time) { return std::chrono::duration<double, std::milli>(time).count(); }

}  // namespace

void Viewer::say(const std::string& what) {
  status_ = what;
  std::printf("%s\n", what.c_str());
  std::fflush(stdout);
}

void Viewer::complain(const std::string& sentence) {
  command::complain(sentence);
  faults_.push_back(sentence);
  if (faults_.size() > kMostFaults) faults_.erase(faults_.begin());
}

bool Viewer::good(const Result<void>& done) {
  if (!done) complain(done.error());
  return static_cast<bool>(done);
}

void Viewer::open(const std::filesystem::path& file, std::span<const Assignment> assignments) {
  auto stage = Stage::open(window_->device(), file, assignments);
  if (!stage) return complain(stage.error());
  workbench_.reset();   // they read the old one's buffers
  shading_.reset();
  stage_ = std::move(*stage);
  orbit_ = Orbit(stage_->scene().camera);
  draft_ = stage_->scene();
  tuning_ = {};
  cuts_ = false;   // the new one has no knife
  save_as_ = file.stem().string() + ".changed.json";
  ball_radius_ = static_cast<float>(0.1 * orbit_.distance());
  window_->set_title("Weft: " + file.filename().string());
  for (const std::string& note : stage_->simulation().fabric().notes) std::printf("note: %s\n", note.c_str());
  say("opened " + file.filename().string());
}

Result<void> Viewer::run(const ViewerOptions& options) {
  open(options.file, options.assignments);
  is_playing_ = !options.is_paused;
  while (!window_->wants_to_close() && !command::interrupted()) {
    if (auto done = frame(); !done) return done;
    if (options.frames && pictures_ >= *options.frames) break;
  }
  const VkExtent2D size = picture_size();
  char text[200];
  std::snprintf(text, sizeof text, "%u pictures, the last of %u x %u, and %u frames; medians: simulated in %.1f ms, drawn in %.1f ms",
                pictures_, size.width, size.height, frames_, median(simulated_times_), median(drawn_times_));
  say(text);
  return {};
}

Result<void> Viewer::frame() {
  const bool idle = !is_playing_ || !stage_ || window_->is_minimised();
  window_->poll(idle ? 0.1 : 0);
  for (const std::filesystem::path& file : window_->take_dropped()) {
    open(file, {});
    is_settled_ = false;
  }
  const Clock::time_point now = Clock::now();
  wall_s_ = std::min(std::chrono::duration<double>(now - last_).count(), 1.0);
  last_ = now;
  if (window_->take_heard()) {
    heard_ = now;
    drawn_since_heard_ = 0;
    is_settled_ = false;
  }
  if (is_playing_) is_settled_ = false;
  if (stage_) step();
  return is_settled_ ? Result<void>() : draw();
}

// Frames of the simulation where they are due: as fast as real time, or as fast as it can. Where a picture takes longer than a frame, as
// many as take the time of a picture: drawing never has more of the time than the simulation while that is behind.
void Viewer::step() {
  if (!is_playing_) return;
  const double period = 1 / stage_->scene().solver.rate;
  due_ += speed_ * wall_s_;
  double spent = 0;
  for (; is_playing_ && due_ >= period && (spent == 0 || spent < window_->drawn_ms()); spent += simulated_ms_) {
    due_ -= period;
    step_once();
  }
  due_ = std::min(due_, period);
}

void Viewer::step_once() {
  const Clock::time_point start = Clock::now();
  if (!good(stage_->step())) return set_playing(false);
  const Simulation& simulation = stage_->simulation();
  if (!good(compute::wait_for(window_->device(), simulation.ready_semaphore(), simulation.ready_value()))) set_playing(false);
  simulated_ms_ = milliseconds(Clock::now() - start);
  add(simulated_times_, simulated_ms_);
  ++frames_;
}

// Nothing moves, and the user does nothing. What a click does takes the interface up to three frames.
bool Viewer::is_still() const {
  return !is_playing_ && drawn_since_heard_ > 3 && std::chrono::duration<double>(Clock::now() - heard_).count() > kRest;
}

double Viewer::scale_at_rest() const {
  const double whole = window_->drawn_ms() / (drawn_at_ * drawn_at_);   // at most: not all of it grows with the picture
  return std::clamp(std::sqrt(kDrawingAtRest / std::max(whole, 1.0)), kScales[scale_], 1.0);
}

VkExtent2D Viewer::picture_size() const {
  const VkExtent2D whole = window_->size();
  const auto part = [&](std::uint32_t pixels) { return std::max(16u, static_cast<std::uint32_t>(drawn_at_ * pixels)); };
  return {part(whole.width), part(whole.height)};
}

// Down at once, up late: a picture that changes its size every second is worse than a coarse one.
void Viewer::choose_scale() {
  if (is_settled_) return;   // its time says nothing of a picture that moves
  const double budget = std::max(kDrawing, is_playing_ ? simulated_ms_ : 0.0), took = window_->drawn_ms();
  slow_ = took > 1.2 * budget ? slow_ + 1 : 0;
  const double larger = scale_ == 0 ? 1 : kScales[scale_ - 1] / kScales[scale_];
  fast_ = took * larger * larger < 0.8 * budget ? fast_ + 1 : 0;
  if (slow_ >= 3 && scale_ + 1 < kScales.size()) ++scale_, slow_ = fast_ = 0;
  if (fast_ >= 60 && scale_ > 0) --scale_, slow_ = fast_ = 0;
}

Result<void> Viewer::draw() {
  auto commands = window_->begin();
  if (!commands) return commands.take_error();
  if (!*commands) {   // minimised: only events
    window_->poll(0.05);
    return {};
  }
  draw_panels();   // what it changes is in this picture
  obey_keys();
  obey_pointer();
  ImGui::Render();
  is_settled_ = is_still();
  drawn_at_ = is_settled_ ? scale_at_rest() : kScales[scale_];
  const VkExtent2D size = picture_size();
  auto image = picture(**commands, size);
  if (!image) return image.take_error();
  if (auto done = window_->finish(*image, size); !done) return done;
  ++pictures_;
  ++drawn_since_heard_;
  add(drawn_times_, window_->drawn_ms());
  choose_scale();
  return {};
}

Result<VkImage> Viewer::picture(VkCommandBuffer commands, VkExtent2D size) {
  if (stage_ && (shown_ != stage_->generation() || !workbench_)) {
    shading_.reset();
    workbench_.reset();
    auto made = Workbench::create(window_->device(), stage_->simulation());
    if (!made) return made.take_error();
    workbench_ = std::move(*made);
    for (const std::string& note : workbench_->notes()) complain(note);
    shown_ = stage_->generation();
    shown_splits_ = stage_->simulation().splits();
  }
  if (stage_ && shown_splits_ != stage_->simulation().splits()) {
    if (auto done = workbench_->follow(); !done) return done.take_error();
    shown_splits_ = stage_->simulation().splits();
  }
  if (stage_ && is_rendered_) {
    if (auto done = record_rendered(commands, size); done) return rendered_.handle();
    else complain(done.error());
    is_rendered_ = false;
  }
  if (stage_) {
    const std::vector<Segments> over = lines();
    if (auto done = workbench_->record(commands, size, orbit_.camera(), look_, over); !done) return done.take_error();
    return workbench_->image();
  }
  // Nothing to show: an empty picture.
  if (auto done = make_rendered(size); !done) return done.take_error();
  compute::change_use(window_->device(), commands, rendered_, compute::kUnused, kWritten);
  const VkClearColorValue grey{{0.2f, 0.21f, 0.23f, 1}};
  const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdClearColorImage(commands, rendered_.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &grey, 1, &whole);
  compute::change_use(window_->device(), commands, rendered_, kWritten, kRead);
  return rendered_.handle();
}

Result<void> Viewer::make_rendered(VkExtent2D size) {
  if (rendered_.handle() != VK_NULL_HANDLE && are_same(rendered_.request().size, size)) return {};
  auto made = compute::DeviceImage::create(window_->device(), {"rendered", VK_FORMAT_R8G8B8A8_UNORM, size, kCopied});
  if (!made) return made.take_error();
  rendered_ = std::move(*made);
  return {};
}

// The library's picture is in a format that copies convert; what is shown is copied bit by bit into one that they do not.
Result<void> Viewer::record_rendered(VkCommandBuffer commands, VkExtent2D size) {
  const Simulation& simulation = stage_->simulation();
  if (!shading_) {
    const auto cloths = shaded_cloths(simulation.scene(), simulation.fabric(), simulation.meshes());
    auto made = Shading::create(window_->device(), simulation.scene(), cloths, size);
    if (!made) return made.take_error();
    shading_ = std::move(*made);
    for (const std::string& note : shading_->notes()) std::printf("note: %s\n", note.c_str());
    rendered_splits_ = simulation.splits();
  } else if (!are_same(shading_size_, size)) {
    if (auto done = shading_->resize(size); !done) return done;
  }
  if (rendered_splits_ != simulation.splits()) {
    if (auto done = shading_->follow(shaded_cloths(simulation.scene(), simulation.fabric(), simulation.meshes())); !done) return done;
    rendered_splits_ = simulation.splits();
  }
  shading_size_ = size;
  if (auto done = make_rendered(size); !done) return done;
  shading_->look_from(orbit_.camera());
  if (auto done = shading_->record(commands, {.positions = simulation.positions(),
                                              .normals = simulation.normals(),
                                              .colliders = simulation.colliders(),
                                              .sizes = simulation.collider_sizes()});
      !done)
    return done;
  compute::change_use(window_->device(), commands, rendered_, compute::kUnused, kWritten);
  VkImageCopy whole{};
  whole.srcSubresource = whole.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  whole.extent = {size.width, size.height, 1};
  vkCmdCopyImage(commands, shading_->image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, rendered_.handle(),
                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &whole);
  compute::change_use(window_->device(), commands, rendered_, kWritten, kRead);
  return {};
}

std::vector<Segments> Viewer::lines() {
  std::vector<Segments> over;
  if (shows_contacts_) {
    auto pairs = stage_->contacts();
    if (pairs) over.push_back({{1, 0.2f, 0.7f}, std::move(*pairs)});
    else complain(pairs.error());
  }
  if (!shows_bounds_) return over;
  const auto bounds = stage_->bounds();
  if (!bounds) {
    complain(bounds.error());
    return over;
  }
  const Vec3 &low = bounds->first, &high = bounds->second;
  Segments box{{0.3f, 0.9f, 0.3f}, {}};
  const auto corner = [&](unsigned k) { return Vec3{k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z}; };
  for (unsigned k = 0; k < 8; ++k)
    for (const unsigned axis : {1u, 2u, 4u})
      if ((k & axis) == 0) box.ends.insert(box.ends.end(), {corner(k), corner(k | axis)});
  over.push_back(std::move(box));
  return over;
}

}  // namespace weft::view
