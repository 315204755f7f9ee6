// WeftCloth3D: a MeshInstance3D whose mesh is cloth. Its properties, what the tree says of it, and the notifications it passes on.
#pragma once

#include <memory>

#include "engine/mesh.h"
#include "samples/godot/anchor.h"
#include "samples/godot/drawn.h"
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

  /// As a scene has it, where the node is now, with its mesh. Each anchor has one key; `anchors` receives the nodes behind them.
  /// Errors: a mesh that there is not or that cannot be cloth, a transform that a cloth cannot have.
  struct Described {
    weft::Cloth cloth;
    weft::Mesh mesh;
    std::vector<Anchor*> anchors;
  };
  weft::Result<Described> describe() const;
  /// Whether cloth can be made of what is described, alone. Errors: what check and cook say.
  static weft::Result<void> check_alone(const Described& described, const Shared& shared);

  /// What its stage tells it: it is simulated, or why not.
  void started(const weft::RenderMesh& mesh, const godot::Variant& texture, std::uint32_t first_vertex);
  void stopped();
  void failed(const std::string& sentence);
  const Drawn* drawn() const { return drawn_.get(); }
  const std::string& fault() const { return fault_; }
  std::uint64_t world_id() const { return godot::id_of(world.to_object()); }
  weft::Fabric fabric() const;
  /// Made anew from its properties: the cloth starts where its node is.
  void restart();
  std::vector<weft::Vec3> vertices();

  godot::Variant world;   // a WeftWorld, or nil
  std::string gltf;
  int preset = 1;   // of kPresets
  weft::Fabric own_fabric;
  weft::Maps maps;
  bool tethers = true, bending = true, keeps_folds = false;
  std::uint32_t collision_mask = 1;

 private:
  weft::Result<weft::Mesh> mesh() const;
  void leave();

  Stage* stage_ = nullptr;
  std::unique_ptr<Drawn> drawn_;
  std::string fault_;
};

const godot::Class& cloth_class();

}  // namespace weft_godot
