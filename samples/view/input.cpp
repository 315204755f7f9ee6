// What the keys and the pointer do. The panels' buttons do the same.
#include "samples/view/viewer.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

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
  if (good(stage_->put_ball(comes ? std::optional<double>(ball_radius_) : std::nullopt))) say(comes ? "a ball follows the pointer" : "the ball is gone");
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

Ray Viewer::ray_under_pointer() const {
  const ImGuiIO& io = ImGui::GetIO();
  return ray_through(orbit_.camera(), 2 * io.MousePos.x / io.DisplaySize.x - 1, 2 * io.MousePos.y / io.DisplaySize.y - 1,
                     io.DisplaySize.x / io.DisplaySize.y);
}

void Viewer::obey_pointer() {
  const ImGuiIO& io = ImGui::GetIO();
  if (!ImGui::IsMousePosValid()) return;
  const Camera camera = orbit_.camera();
  const Vec3 ahead = camera.target - camera.eye;
  const Vec3 axis = (1 / length(ahead)) * ahead;
  const bool ours = !io.WantCaptureMouse;
  if (ours && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
    if (io.KeyCtrl) {
      auto done = stage_->pin_or_release(ray_under_pointer());
      if (!done) complain(done.error());
      else say(done->value_or("no cloth there"));
    } else if (!io.KeyShift) {
      auto held = stage_->grab(ray_under_pointer());
      if (!held) complain(held.error());
      else if (*held) say("grabbed cloth");
      else is_turning_ = true;
    }
  }
  if (ours && ImGui::IsMouseClicked(ImGuiMouseButton_Right)) is_turning_ = true;
  if (stage_->is_grabbing()) good(stage_->drag(ray_under_pointer(), axis));
  if (ImGui::IsMouseReleased(ImGuiMouseButton_Left) && stage_->is_grabbing() && good(stage_->let_go())) say("let go");
  if (!ImGui::IsMouseDown(ImGuiMouseButton_Left) && !ImGui::IsMouseDown(ImGuiMouseButton_Right)) is_turning_ = false;

  // How the pointer came to where a button went down is no part of a drag.
  bool begins = false;
  for (const ImGuiMouseButton button : {ImGuiMouseButton_Left, ImGuiMouseButton_Right, ImGuiMouseButton_Middle}) begins |= ImGui::IsMouseClicked(button);
  const ImVec2 moved = begins ? ImVec2(0, 0) : io.MouseDelta;
  const double right = moved.x / io.DisplaySize.y, down = moved.y / io.DisplaySize.y;
  const bool pans = ours && (ImGui::IsMouseDown(ImGuiMouseButton_Middle) || (io.KeyShift && ImGui::IsMouseDown(ImGuiMouseButton_Left)));
  if (pans) orbit_.pan(right, down);
  else if (is_turning_) orbit_.turn(kTurn * right, kTurn * down);
  if (ours && io.MouseWheel != 0) orbit_.zoom(std::pow(kNotch, io.MouseWheel));
  if (stage_->ball() && ours) {
    const Ray ray = ray_under_pointer();
    const float along = dot(ray.direction, axis);
    good(stage_->move_ball(ray.origin + (static_cast<float>(orbit_.distance()) / along) * ray.direction));
  }
}

}  // namespace weft::view
