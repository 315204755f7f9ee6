// WeftCloth3D: a MeshInstance3D whose mesh is cloth. What the tree says of it, and the notifications it passes on; cloth_class.cpp has its
// properties and methods.
#pragma once

#include <memory>

#include "engine/mesh.h"
#include "samples/godot/anchor.h"
#include "samples/godot/drawn.h"
#include "samples/godot/hands.h"
#include "samples/godot/skin.h"
#include "samples/godot/world.h"

namespace weft_godot {

class Stage;

class Cloth : public godot::Instance {
 public:
  using Instance::Instance;
  ~Cloth() override;
  void notified(int what) override;
  std::vector<std::string> warnings() override;
  bool shows(std::string_view property) const override;
  bool saves(std::string_view property) const override;

  /// As a scene has it, with its mesh, where the node was at `start`, or is now. Each anchor has one key, or none where it goes with the
  /// skin; `anchors` receives the nodes behind them. Errors: a mesh that there is not or that cannot be cloth, a transform that a cloth
  /// cannot have.
  struct Described {
    weft::Cloth cloth;
    weft::Mesh mesh;
    godot::Transform start;
    std::vector<Anchor*> anchors;
    std::optional<Skin> skin;   // what carries its skin, where something goes with it
    std::string fault;          // of the skin: a sentence; it is simulated all the same
  };
  weft::Result<Described> describe(std::optional<godot::Transform> start = {}) const;
  /// Whether cloth can be made of what is described, alone. Errors: what check and cook say.
  static weft::Result<void> check_alone(const Described& described, const Shared& shared);

  /// What its stage tells it: it is simulated, or why not.
  void started(const weft::RenderMesh& mesh, const godot::Variant& texture, std::uint32_t first_vertex);
  void stopped();
  void failed(const std::string& sentence);
  void torn(const weft::RenderMesh& mesh);
  const Drawn* drawn() const { return drawn_.get(); }
  const std::string& fault() const { return fault_; }
  std::uint64_t world_id() const { return godot::id_of(world.to_object()); }
  weft::Fabric fabric() const;
  /// Made anew from its properties: the cloth starts where its node is.
  void restart();
  std::vector<weft::Vec3> vertices();

  /// What scripts do: in the next tick; or at once, where there is an answer. What cannot be is a warning in the output.
  void act(Hand hand);
  /// {number, cloth, point, distance}; empty where the ray meets no cloth.
  godot::Variant grab(weft::Vec3 origin, weft::Vec3 direction);
  std::uint32_t cut(weft::Vec3 origin, weft::Vec3 a, weft::Vec3 b);

  /// The mesh of a file becomes the node's, so that it is seen at rest.
  void set_gltf(const std::string& path);
  const std::string& gltf() const { return gltf_; }

  godot::Variant world;   // a WeftWorld, or nil
  int preset = 1;         // of kPresets
  weft::Fabric own_fabric;
  weft::Maps maps;
  bool tethers = true, bending = true, keeps_folds = false;
  std::uint32_t collision_mask = 1;
  bool has_motion = false, has_inertia = false, has_gas = false, has_tear = false;
  weft::MotionConstraints motion;
  double motion_scale = 1;   // of max distances
  weft::Inertia inertia;     // in the node's frame
  weft::Gas gas;
  double gas_amount = 1;   // of what `gas` says
  weft::Tear tear;
  weft::Grip grip;

  static constexpr const char* kPresets[] = {"silk", "cotton", "denim", "leather", "own"};
  static constexpr int kOwn = 4;

 private:
  weft::Result<weft::Mesh> mesh() const;
  void leave();

  std::string gltf_;
  std::optional<weft::Result<weft::Mesh>> file_;   // what is in it
  Stage* stage_ = nullptr;
  std::unique_ptr<Drawn> drawn_;
  std::string fault_;
};

const godot::Class& cloth_class();

}  // namespace weft_godot
