// Pictures of a frame: off-screen metallic-roughness shading of the cloths, the floor and the colliders.
//
// One sun with a shadow map, ambient light from an analytic sky, 4x MSAA, a filmic tone map; camera and light are the
// scene's. Positions and normals are bound as vertex buffers where the simulation left them. A picture of one frame is
// bitwise the same each time it is drawn on one device.
//
// Limitations: no reflections of one thing in another; ambient occlusion is found in screen space, so what is outside the
// picture occludes nothing; the shadow map covers the cloths' rest places and the colliders with a margin, so what is
// thrown far out of there casts no shadow. A plane is drawn from the side its normal points to only, and casts none.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compute/result.h"
#include "engine/fabric.h"
#include "engine/frame_view.h"
#include "engine/mesh.h"
#include "engine/scene.h"
#include "engine/image.h"

namespace weft {

namespace compute {
class Device;
}

/// What is drawn of a cloth or a mesh collider besides its moving vertices. Both are read in create only.
struct ShadedCloth {
  const RenderMesh* mesh = nullptr;
  const Appearance* appearance = nullptr;   // null for mesh colliders, which have the scene's colour for them
  double transmission = 0.15;  // fraction of light from behind that shines through, 0 ... 1
  bool shown = true;           // false: its vertices are there and not drawn, as those of a cloth that carries a render mesh
};

/// All of a simulation (its scene, fabric and meshes): its cloths, those that carry a render mesh hidden; its mesh colliders; its render
/// meshes, with the looks of the cloths that carry them. Points into what was given.
std::vector<ShadedCloth> shaded_cloths(const Scene& scene, const CookedFabric& fabric, std::span<const Mesh> meshes);

/// One frame. Views are RGBA32F and hold the vertices of every cloth and mesh collider in create's order. Writes on the
/// device's queue are waited for; writes from elsewhere must be signalled by `ready`.
struct Poses {
  FrameView positions, normals;
  std::span<const ColliderPose> colliders;  // as many as the scene has
  VkSemaphore ready = VK_NULL_HANDLE;       // timeline semaphore to wait for, or none
  std::uint64_t ready_value = 0;
  std::span<const ColliderSize> sizes = {};  // of the colliders, where they were resized (Simulation::collider_sizes); empty: the scene's
};

class Shading {
 public:
  /// `cloths` are the scene's and, where they are to be seen, its mesh colliders and render meshes after them: in the order of
  /// Simulation::meshes().
  /// Loads textures and allocates and compiles everything. `device` must outlive the result and needs a graphics queue.
  /// Errors: what read_image refuses of a texture; a picture size outside 1 ... 8192; a mesh with no triangle, or with an index or a material
  /// out of range; a null appearance that is no mesh collider's; neither cloth nor collider; a light without a direction; a device that does not
  /// draw; memory; what Vulkan refuses.
  static Result<std::unique_ptr<Shading>> create(compute::Device& device, const Scene& scene, std::span<const ShadedCloth> cloths,
                                                 VkExtent2D size);
  ~Shading();
  Shading(const Shading&) = delete;
  Shading& operator=(const Shading&) = delete;

  /// Sentences of what the materials of meshes' files have and pictures do not show (Appearance::mesh_materials).
  std::span<const std::string> notes() const;

  /// From the next picture on: the triangles and texture coordinates of create's cloths as they are now, where cloth has torn
  /// (Simulation::splits). As many as in create, and none may be drawn meanwhile. Errors: another number of cloths, vertices, triangles or
  /// triangles of a material; an index or a material out of range; memory; what Vulkan refuses. Nothing has changed then.
  Result<void> follow(std::span<const ShadedCloth> cloths);

  /// Sets the camera of the pictures that follow.
  void look_from(const Camera& camera);

  /// Sets the size of the pictures that follow. What depends on it is made anew, image() too; textures, meshes and pipelines stay as they
  /// are. A recorded picture must be done. Errors: a size outside 1 ... 8192; memory; what Vulkan refuses. All is then as it was.
  Result<void> resize(VkExtent2D size);

  /// Draws, waits and reads back: sRGB, opaque.
  /// Errors: views that are null, of a foreign format or too short; colliders that do not match the scene's; memory; what Vulkan refuses.
  /// The next picture can be drawn all the same, but on a lost device.
  Result<Image> draw(const Poses& poses);

  /// Records a picture into the host's command buffer (recording state, outside a render pass, on a family that draws). It is left in
  /// image(), of create's or resize's size, R8G8B8A8_SRGB, in the layout TRANSFER_SRC_OPTIMAL, for copies and blits behind it on the queue. Of what is
  /// earlier on the queue it waits for everything; `ready` of the poses is the host's to wait for. The host must know that a recorded
  /// picture is done before the next one is recorded or drawn, and before this is destroyed. Errors: no command buffer; as draw.
  Result<void> record(VkCommandBuffer commands, const Poses& poses);
  VkImage image() const;

 private:
  Shading();
  struct State;
  struct Geometry;
  std::unique_ptr<State> state_;
};

}  // namespace weft
