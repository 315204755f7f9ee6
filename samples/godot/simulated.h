// A simulation on Godot's device, as the render thread has it: made, stepped, recorded for `weft run`, and destroyed there.
#pragma once

#include <mutex>

#include "samples/godot/bounds.h"
#include "samples/godot/hands.h"
#include "samples/godot/poses.h"
#include "samples/godot/recording.h"
#include "samples/godot/vertex_texture.h"

namespace weft_godot {

/// What a simulation is made of. A collider's and an anchor's first key says where it is at the start.
struct Setup {
  std::uint64_t number = 0;   // of those that the stage has made, from 1 on
  weft::Scene scene;
  std::vector<weft::Mesh> meshes;
  std::vector<std::optional<std::uint32_t>> carried;   // of each cloth: which of the last simulation's it was, whose state it keeps
  std::string recording;                               // a folder; empty: none
};

/// What happens in a tick of Godot's physics to a cloth.
struct ClothTick {
  std::vector<Placed> anchors;   // how they have moved since the start
  std::vector<Placed> bones;     // of its skin, where they are; none: it has none
  std::optional<double> gas;     // its amount is another
  struct Motion {
    double scale = 1, stiffness = 1;   // of its motion constraints
    bool operator==(const Motion&) const = default;
  };
  std::optional<Motion> motion;
};

/// What happens in a tick of Godot's physics.
struct Tick {
  double seconds = 0;
  std::uint32_t slot = 0;                            // of the texture, for its end
  std::vector<std::optional<weft::Key>> colliders;   // where they are; none: where they were
  std::vector<std::uint32_t> placed;                 // those that are there at once, and meet nothing on the way
  std::vector<std::pair<std::uint32_t, weft::ColliderSize>> resized;
  std::vector<ClothTick> cloths;
  std::vector<Hand> hands;
  std::optional<weft::Vec3> wind;
  std::vector<std::pair<std::uint32_t, weft::Air::Field>> fields;   // of the air, those that have moved
};

/// What the main thread sees of it.
struct Seen {
  std::uint64_t setup = 0;   // which it was made of
  bool is_running = false;
  std::string failure;   // a sentence; it stands still then
  godot::Rid texture;
  std::vector<std::uint32_t> first_vertices;   // of each cloth
  std::vector<godot::Box> boxes;               // of each cloth, some ticks ago
  std::uint64_t boxes_of_tick = 0;
  std::vector<std::shared_ptr<const weft::RenderMesh>> torn;   // of each cloth: what it has become; null: whole
  std::uint64_t torn_in_tick = 0;                              // the last that tore any
};

class Simulated {
 public:
  Simulated();
  ~Simulated();
  /// These are for the render thread.
  void make(Setup setup);
  void tick(const Tick& tick);
  void end();
  weft::Result<std::vector<weft::Vec3>> read_vertices(std::uint32_t cloth);
  weft::Result<std::optional<Hands::Held>> grab(weft::Vec3 origin, weft::Vec3 direction, const weft::Grip& grip);
  weft::Result<std::uint32_t> cut(weft::Vec3 origin, weft::Vec3 a, weft::Vec3 b);

  /// Any thread.
  Seen seen() const;
  static int alive();   // simulations, all together

 private:
  struct Running;
  weft::Result<void> try_make(Setup& setup);
  weft::Result<void> try_tick(const Tick& tick);
  weft::Result<void> move(const Tick& tick);
  weft::Result<void> move_anchors(const Tick& tick);
  weft::Result<void> move_cloths(const Tick& tick);
  weft::Result<void> move_air(const Tick& tick);
  void act(std::span<const Hand> hands);
  void look_at_tears();
  static weft::Result<void> carry(const weft::Simulation& from, weft::Simulation& to,
                                  std::span<const std::optional<std::uint32_t>> carried);
  void fail_with(const std::string& sentence);
  void look_at_bounds();
  void spoil(const char* why);

  std::unique_ptr<Running> running_;
  mutable std::mutex mutex_;
  Seen seen_;
};

/// Destroys textures that Godot may still have drawn with when they were given up, once it no longer does; all of them before the end.
void destroy_given_up(bool all);

}  // namespace weft_godot
