// What the keys and the pointer do. The panels' buttons do the same.
#include "samples/view/viewer.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace weft::view {
namespace {

constexpr double kTurn = 3.2;     // radians a height of the window
constexpr double kNotch = 0.88;   // of the distance, a notch of the wheel

void toggle(bool& what) { what = !what; }

}  // namespace

void Viewer::set_playing(bool on) {
  if (is_playing_ == on) return;
  is_playing_ = on;
  due_ = 0;
  say((on ? "plays from frame " : "paused at frame ") + std::to_string(stage_ ? stage_->frame() : 0));
}

void Viewer::step_alone() {
  set_playing(false);
  step_once();
  say("at frame " + std::to_string(stage_->frame()));
}

void Viewer::reset() {
  if (good(stage_->reset())) say("back at the start");
}

void Viewer::frame_all() {
  const auto bounds = stage_->bounds();
  if (!bounds) return complain(bounds.error());
  orbit_.frame(bounds->first, bounds->second);
  say("all cloth in view");
}

void Viewer::keep() {
  if (good(stage_->keep())) say("kept frame " + std::to_string(stage_->frame()));
}

void Viewer::go_back(std::size_t kept) {
  if (good(stage_->go_back_to(kept))) say("back at frame " + std::to_string(stage_->frame()));
}

void Viewer::change_scene() {
  const auto start = Clock::now();
  if (good(stage_->change(draft_))) {
    char text[64];
    std::snprintf(text, sizeof text, "changed; made anew in %.0f ms", 1e3 * std::chrono::duration<double>(Clock::now() - start).count());
    say(text);
  } else {
    draft_ = stage_->scene();
  }
  last_ = Clock::now();   // that was no time of the simulation's
}

void Viewer::toggle_ball() {
  const bool comes = !stage_->ball();
  if (good(stage_->put_ball(comes ? std::optional<double>(ball_radius_) : std::nullopt)))
    say(comes ? "a ball follows the pointer" : "the ball is gone");
}

void Viewer::toggle_knife() {
  if (!good(stage_->take_knife(!cuts_))) return;
  cuts_ = !cuts_;
  say(cuts_ ? "a knife: draw a line across cloth with the left button" : "the knife is put away");
  last_ = Clock::now();
}

// Along the line that was drawn.
void Viewer::cut() {
  if (std::hypot(x_ - from_x_, y_ - from_y_) < 2) return;
  const auto count = stage_->cut(ray_at(from_x_, from_y_), ray_under_pointer());
  if (!count) complain(count.error());
  else if (*count == 0) say("no cloth there to cut");
  else say("cut: " + std::to_string(*count) + " vertices have become two");
  last_ = Clock::now();
}

void Viewer::obey_keys() {
  for (const Key& pressed : window_->take_keys()) {
    if (pressed.with_control && pressed.key == GLFW_KEY_Q) window_->close();
    if (!ImGui::GetIO().WantTextInput && !pressed.with_control && stage_) obey(pressed);
  }
}

void Viewer::obey(const Key& pressed) {
  if (pressed.key == GLFW_KEY_PERIOD) step_alone();   // as long as it is held
  if (pressed.again) return;
  if (pressed.key >= GLFW_KEY_1 && pressed.key <= GLFW_KEY_1 + VIEW_OCCLUSION) {
    look_.colouring = static_cast<uint>(pressed.key - GLFW_KEY_1);
    is_rendered_ = false;
  }
  switch (pressed.key) {
    case GLFW_KEY_SPACE: set_playing(!is_playing_); break;
    case GLFW_KEY_R: reset(); break;
    case GLFW_KEY_F: frame_all(); break;
    case GLFW_KEY_K: keep(); break;
    case GLFW_KEY_BACKSPACE:
      if (!stage_->kept().empty()) go_back(stage_->kept().size() - 1);
      break;
    case GLFW_KEY_G: toggle_ball(); break;
    case GLFW_KEY_X: toggle_knife(); break;
    case GLFW_KEY_TAB: toggle(shows_panels_); break;
    case GLFW_KEY_H: toggle(shows_help_); break;
    case GLFW_KEY_W: toggle(look_.wires); break;
    case GLFW_KEY_N: toggle(look_.spikes); break;
    case GLFW_KEY_A: toggle(look_.anchors); break;
    case GLFW_KEY_C: toggle(shows_contacts_); break;
    case GLFW_KEY_B: toggle(shows_bounds_); break;
    case GLFW_KEY_O: toggle(look_.colliders); break;
    case GLFW_KEY_0: toggle(is_rendered_); break;
    default: break;
  }
}

Ray Viewer::ray_at(double x, double y) const {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  return ray_through(orbit_.camera(), 2 * x / size.x - 1, 2 * y / size.y - 1, size.x / size.y);
}

bool Viewer::is_over_panels(double x, double y) const {
  return std::ranges::any_of(panels_, [&](const Panel& one) { return x >= one.left && x < one.right && y >= one.top && y < one.bottom; });
}

void Viewer::obey_pointer() {
  for (const Pointed& pointed : window_->take_pointed())
    if (stage_) obey(pointed);
  if (!stage_) return;
  const Camera camera = orbit_.camera();
  const Vec3 ahead = camera.target - camera.eye;
  const Vec3 axis = (1 / length(ahead)) * ahead;
  if (stage_->is_grabbing()) good(stage_->drag(ray_under_pointer(), axis));
  if (!stage_->ball() || is_over_panels(x_, y_)) return;
  const Ray ray = ray_under_pointer();
  good(stage_->move_ball(ray.origin + (static_cast<float>(orbit_.distance()) / dot(ray.direction, axis)) * ray.direction));
}

void Viewer::obey(const Pointed& pointed) {
  switch (pointed.what) {
    case Pointed::What::moved: move_to(pointed.x, pointed.y); break;
    case Pointed::What::scrolled:
      if (!is_over_panels(x_, y_)) orbit_.zoom(std::pow(kNotch, pointed.y));
      break;
    case Pointed::What::pressed:
      x_ = pointed.x;   // how it came there is no part of a drag
      y_ = pointed.y;
      if (drag_ == Drag::nothing && !is_over_panels(x_, y_)) press(pointed);
      break;
    case Pointed::What::released:
      if (drag_ == Drag::pulls && good(stage_->let_go())) say("let go");
      if (drag_ == Drag::cuts) cut();
      drag_ = Drag::nothing;
      break;
  }
}

void Viewer::press(const Pointed& pointed) {
  const bool left = pointed.button == GLFW_MOUSE_BUTTON_LEFT;
  if (pointed.button == GLFW_MOUSE_BUTTON_MIDDLE || (left && pointed.with_shift)) {
    drag_ = Drag::pans;
  } else if (left && pointed.with_control) {
    auto done = stage_->pin_or_release(ray_under_pointer());
    if (!done) complain(done.error());
    else say(done->value_or("no cloth there"));
  } else if (left && cuts_) {
    drag_ = Drag::cuts;
    from_x_ = x_;
    from_y_ = y_;
  } else if (left) {
    auto held = stage_->grab(ray_under_pointer());
    if (!held) return complain(held.error());
    drag_ = *held ? Drag::pulls : Drag::turns;
    if (*held) say("grabbed cloth");
  } else {
    drag_ = Drag::turns;
  }
}

void Viewer::move_to(double x, double y) {
  const double height = ImGui::GetIO().DisplaySize.y;
  const double right = (x - x_) / height, down = (y - y_) / height;
  x_ = x;
  y_ = y;
  if (drag_ == Drag::turns) orbit_.turn(kTurn * right, kTurn * down);
  if (drag_ == Drag::pans) orbit_.pan(right, down);
}

}  // namespace weft::view
