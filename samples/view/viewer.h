// The viewer: what is on show, how it is shown, and what the user does to it.
//
// A frame: events, the panels, what the pointer and the keys ask for, a frame of the simulation where it is due, a picture of it. Nothing
// of the GPU is under way while panels and pointer work, so that they may change everything.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/shading/shading.h"
#include "samples/view/orbit.h"
#include "samples/view/stage.h"
#include "samples/view/tuning.h"
#include "samples/view/window.h"
#include "samples/view/workbench.h"

namespace weft::view {

struct ViewerOptions {
  std::filesystem::path file;
  std::vector<Assignment> assignments;
  bool is_paused = false;
  std::optional<std::uint32_t> frames;   // pictures after which it closes by itself
};

class Viewer {
 public:
  /// A file that cannot be shown is no error: its sentence is, in the window, and another can be dropped there.
  explicit Viewer(Window& window) : window_(&window) {}
  Result<void> run(const ViewerOptions& options);

 private:
  using Clock = std::chrono::steady_clock;

  void open(const std::filesystem::path& file, std::span<const Assignment> assignments);
  Result<void> frame();
  void step();
  Result<void> draw();
  Result<VkImage> picture(VkCommandBuffer commands, VkExtent2D size);
  Result<void> record_rendered(VkCommandBuffer commands, VkExtent2D size);
  Result<void> make_rendered(VkExtent2D size);
  void choose_scale();
  bool is_still() const;
  double scale_at_rest() const;
  VkExtent2D picture_size() const;
  std::vector<Segments> lines();

  // What the user does (input.cpp).
  void obey_keys();
  void obey(const Key& pressed);
  void obey_pointer();
  void obey(const Pointed& pointed);
  void press(const Pointed& pointed);
  void move_to(double x, double y);
  bool is_over_panels(double x, double y) const;
  Ray ray_at(double x, double y) const;
  Ray ray_under_pointer() const { return ray_at(x_, y_); }
  void set_playing(bool on);
  void step_once();
  void step_alone();
  void reset();
  void frame_all();
  void keep();
  void go_back(std::size_t kept);
  void change_scene();
  void toggle_ball();
  void toggle_knife();
  void cut();

  // The panels (panels.cpp).
  void draw_panels();
  void end_panel();
  void draw_player();
  void draw_look();
  void draw_figures();
  void draw_times();
  void draw_scene();
  void draw_messages();

  /// What happened, for the status line and for those who read along on stdout.
  void say(const std::string& what);
  /// A sentence in red, and on stderr.
  void complain(const std::string& sentence);
  bool good(const Result<void>& done);   // complains

  Window* window_;
  std::unique_ptr<Stage> stage_;
  std::unique_ptr<Workbench> workbench_;
  std::unique_ptr<Shading> shading_;     // once it is asked for
  VkExtent2D shading_size_{};
  compute::DeviceImage rendered_;        // its picture, as bits that are no longer converted; or an empty one
  std::uint32_t shown_splits_ = 0, rendered_splits_ = 0;   // how much of its cloth was torn then
  std::uint64_t shown_ = 0;              // the stage's generation that these are of
  Orbit orbit_;
  Look look_;
  bool is_rendered_ = false, shows_contacts_ = false, shows_bounds_ = false, shows_panels_ = true, shows_help_ = false;
  bool is_playing_ = true;
  enum class Drag { nothing, turns, pans, pulls, cuts };
  Drag drag_ = Drag::nothing;
  double x_ = 0, y_ = 0;                 // of the pointer, in screen coordinates
  double from_x_ = 0, from_y_ = 0;       // where a cut begins
  bool cuts_ = false;                    // the left button, instead of grabbing
  struct Panel {
    float left, top, right, bottom;
  };
  std::vector<Panel> panels_;            // as they were drawn last
  double speed_ = 1, due_ = 0;           // of real time; s of the simulation that are due
  double simulated_ms_ = 0, wall_s_ = 0;
  std::vector<double> simulated_times_, drawn_times_;   // ms, of the last thousand
  std::size_t scale_ = 0;
  double drawn_at_ = 1;                  // scale of the last picture
  Clock::time_point heard_ = Clock::now();   // when the user last did something
  std::uint32_t drawn_since_heard_ = 0;  // pictures
  bool is_settled_ = false;              // nothing has changed since the last picture, which was drawn as fine as it may be
  int slow_ = 0, fast_ = 0;              // frames in a row
  std::uint32_t pictures_ = 0, frames_ = 0;   // drawn; simulated
  Clock::time_point last_ = Clock::now();
  Scene draft_;                          // as the panel has it
  Tuning tuning_;
  std::string status_, save_as_;
  std::vector<std::string> faults_;
  float ball_radius_ = 0.1f;             // m
};

}  // namespace weft::view
