// What the air of a WeftWorld does besides its wind: WeftGust, an entry of its list, and WeftAirField3D, a node of the tree.
#pragma once

#include "engine/scene.h"
#include "samples/godot/classes.h"

namespace weft_godot {

class Gust : public godot::Instance {
 public:
  using Instance::Instance;
  weft::Air::Gust gust;
};

/// A jet, a vortex, or a box or sphere of moving air, where its node is. It goes and turns with the node, and is still while that is
/// hidden.
class AirField : public godot::Instance {
 public:
  using Instance::Instance;
  ~AirField() override;
  void notified(int what) override;
  std::vector<std::string> warnings() override;
  bool shows(std::string_view property) const override;

  /// All that are in the tree, in the order in which they came.
  static const std::vector<AirField*>& all();
  /// As a scene has it, where the node is now.
  weft::Air::Field described() const;
  std::uint64_t world_id() const { return godot::id_of(world.to_object()); }

  weft::Air::Field field;   // in the node's own axes, without a centre
  godot::Variant world;     // a WeftWorld, or nil

 private:
  void leave();
};

const godot::Class& gust_class();
const godot::Class& air_field_class();

}  // namespace weft_godot
