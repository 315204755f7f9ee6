// How a cloth is drawn: its node's own instance, with a mesh whose vertices a shader fetches from the texture of the simulation.
//
// Where a vertex is lies in no vertex buffer, so that the node's transform has nothing to say of it. It says something else: its origin is
// (slot of the tick before, slot of the newest tick, how far between the two). Godot tells a shader the transform of the frame before where
// it draws motion vectors, and so the same shader finds where the vertex was drawn then.
#pragma once

#include "engine/mesh.h"
#include "samples/godot/godot.h"

namespace weft_godot {

/// A moment between two ticks.
struct Moment {
  std::uint32_t before = 0, newest = 0;
  float between = 1;
};

class Drawn {
 public:
  /// Draws `node`, a MeshInstance3D, by a texture. `folder`: where the plug-in's shader is.
  Drawn(godot::Object node, const weft::RenderMesh& mesh, const godot::Variant& texture, std::uint32_t first_vertex,
        const std::string& folder);
  ~Drawn();   // the node is drawn as Godot draws it again
  Drawn(const Drawn&) = delete;
  Drawn& operator=(const Drawn&) = delete;

  /// Its triangles have other vertices.
  void reshape(const weft::RenderMesh& mesh);
  /// Before a frame is drawn. `box`: around the cloth, in the world.
  void present(const Moment& moment, const godot::Box& box) const;

 private:
  godot::Variant material_for(const godot::Variant& source, const godot::Variant& texture, std::uint32_t first_vertex,
                              const godot::Variant& shader) const;

  std::uint64_t node_;
  godot::Rid instance_;
  godot::Variant server_, mesh_;
  std::vector<godot::Variant> materials_;
};

}  // namespace weft_godot
