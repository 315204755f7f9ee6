// What carries the skin of a cloth: the bones of a Skeleton3D, or the cloth's own node where its mesh has no joints.
//
// A joint takes a point by (where its bone is) (its inverse bind matrix), as glTF has it. Bones are taken apart into what a glTF's
// animation holds, translation, rotation and scale, and Weft's own function makes joints of these, so that a recording played by `weft run`
// has the same bits.
#pragma once

#include "engine/mesh.h"
#include "samples/godot/poses.h"

namespace weft_godot {

class Skin {
 public:
  /// The joint that goes with the cloth's own node.
  static constexpr const char* kOfNode = "node of the cloth";

  /// Gives `mesh`, which is in the world already, a skin whose joints are bones of the Skeleton3D that the MeshInstance3D names, by the
  /// names of its file's joints or by the node's Skin; or a single joint that goes with the node. `with_node`: there is such a joint in
  /// any case. `start`: where the node has the mesh at rest. `fault` receives what is not as it should be, and is then left out.
  static Skin bind(godot::Object node, const godot::Transform& start, bool with_node, weft::Mesh& mesh, std::string& fault);

  /// Where bones are, now. What is gone, mirrored or of no size stays where it was.
  const std::vector<Placed>& look();

 private:
  std::uint64_t node_ = 0, carrier_ = 0;   // the cloth's; a Skeleton3D, or the cloth's
  std::vector<std::int64_t> bones_;        // of each joint; -1: the carrier itself, -2: the cloth's node
  std::vector<Placed> bones_at_;
};

/// Writes the places of bones into a skin's animation, as its only keys.
void set_keys(weft::Skin& skin, std::span<const Placed> bones);
/// Adds keys that hold from `time` (s) on.
void add_keys(weft::Skin& skin, float time, std::span<const Placed> bones);

}  // namespace weft_godot
