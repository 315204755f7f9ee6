// WeftAnchor3D: which vertices of the cloth above it are held, and what they follow.
#pragma once

#include <optional>

#include "engine/scene.h"
#include "samples/godot/classes.h"

namespace weft_godot {

class Anchor : public godot::Instance {
 public:
  using Instance::Instance;
  void notified(int what) override;
  std::vector<std::string> warnings() override;

  /// As a scene has it; without keys.
  weft::Anchor choice() const;
  /// Where the thing is that it follows. None: it is gone, or has no such bone.
  std::optional<godot::Transform> followed() const;

  std::vector<std::int32_t> vertices;
  std::string map;
  double top = 0;    // m
  weft::Vec3 size;   // m; 0 along an axis: no box
  std::uint32_t every = 1;
  godot::Variant follow;   // NodePath
  std::string bone;
  bool with_skin = false;   // instead: where the cloth's skin takes them

 private:
  godot::Variant followed_node() const;
};

const godot::Class& anchor_class();

}  // namespace weft_godot
