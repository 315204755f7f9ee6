// A simulation as the main thread has it: the cloths that share it, the shapes they meet, and what each tick of physics tells the render
// thread.
//
//   a tick    every node has moved by then (cloths come last): where shapes and anchors are goes to the render thread, which records and
//             submits a frame of Weft's
//   a frame   says between which two ticks it lies, and where each cloth is at most
#pragma once

#include <memory>
#include <set>

#include "samples/godot/cloth.h"
#include "samples/godot/colliders.h"
#include "samples/godot/simulated.h"

namespace weft_godot {

class Stage {
 public:
  explicit Stage(const godot::Variant& world) : world_(world) {}
  ~Stage();
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// The stage of a WeftWorld, or of those without one.
  static Stage& of(const godot::Variant& world);
  static std::vector<std::unique_ptr<Stage>>& all();
  /// Shapes have come or gone: simulations are made anew where that matters.
  static void shapes_changed();
  /// A field of a world's air has come or gone.
  static void air_changed(std::uint64_t world);
  static void before_drawing();
  static void end_all();

  void add(Cloth& cloth);
  void remove(Cloth& cloth);
  void restart(Cloth& cloth);
  /// A cloth was ticked: the first one in a tick of physics moves the simulation on.
  void tick(double seconds);
  std::vector<weft::Vec3> vertices(const Cloth& cloth);

  /// In the next tick.
  void act(Cloth& cloth, Hand hand) { hands_.emplace_back(&cloth, std::move(hand)); }
  /// At once. Errors: what the simulation refuses, or that there is none.
  struct Grabbed {
    Hands::Held held;
    godot::Object cloth;
  };
  weft::Result<std::optional<Grabbed>> grab(weft::Vec3 origin, weft::Vec3 direction, const weft::Grip& grip);
  weft::Result<std::uint32_t> cut(weft::Vec3 origin, weft::Vec3 a, weft::Vec3 b);

 private:
  struct Member {
    Cloth* cloth;
    std::optional<std::uint32_t> place;                                // in the simulation that runs
    std::vector<std::pair<std::uint64_t, godot::Transform>> anchors;   // node, and the inverse of where what it follows was at the start
    std::vector<Placed> moved;                                         // the last that is known of each
    godot::Transform start;                                            // where its mesh was put, and which vertices its anchors chose then
    std::vector<weft::Anchor> choices;
    std::optional<Skin> skin;
    double gas = 1;   // what the simulation knows
    ClothTick::Motion motion;
    bool is_shown = false;
    godot::Box box;   // of the last look, and its change a tick
    weft::Vec3 speed;
    std::uint64_t box_of_tick = 0;
  };
  void make();
  void add_shapes(weft::Scene& scene, std::vector<weft::Mesh>& meshes, const std::vector<Cloth*>& cloths);
  void move_shapes(Tick& tick);
  void add_fields(weft::Scene& scene);
  void move_cloths(Tick& tick);
  void move_anchors(Member& member, ClothTick& tick);
  void move_air(Tick& tick);
  std::uint32_t free_slot() const;
  void look(const Seen& seen);
  void set_texture(godot::Rid texture);
  void present();
  void give_up(const std::string& sentence);

  godot::Variant world_;
  std::vector<Member> members_;
  std::vector<Shape> shapes_;
  std::set<std::uint64_t> resized_;
  std::shared_ptr<Simulated> simulated_;
  godot::Variant texture_;   // Texture2DArrayRD
  godot::Rid texture_rid_;
  bool is_dirty_ = true;
  std::int64_t ticked_ = -1;   // Engine.get_physics_frames()
  std::uint64_t ticks_ = 1, setups_ = 0;
  Moment moment_, drawn_;
  std::vector<weft::RenderMesh> drawn_meshes_;   // of each cloth of the simulation
  std::uint64_t torn_in_tick_ = 0;
  weft::Vec3 wind_;
  std::vector<std::pair<std::uint64_t, weft::Air::Field>> fields_;   // nodes, and where they were
  std::vector<std::pair<Cloth*, Hand>> hands_;
  std::set<std::string> told_;   // faults that were printed
};

}  // namespace weft_godot
