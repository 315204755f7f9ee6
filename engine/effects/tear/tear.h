// Tearing and cutting: where points of a cloth become two. Without Vulkan: the host looks at where a frame has left the cloth, splits its mesh,
// and cooks it anew (engine/solve/tears.cpp).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/fabric.h"
#include "engine/mesh.h"

namespace weft {

/// Frames from one look at the cloth to the next, and from a look to the frame that begins with what it found.
inline constexpr std::uint64_t kFramesALook = 3;

/// Of the cloths of a scene, an entry each; empty of those that do not tear.
struct TearLists {
  std::vector<std::vector<float>> limits;          // of each point: the strain at which it tears
  std::vector<std::vector<std::uint32_t>> orders;  // points, particle after particle
};

/// Whether any cloth tears.
bool tears(const Scene& scene);

/// How many points may still become two.
std::uint64_t spare_points(const CookedFabric& fabric);

/// Room for what its cloths may tear, at the end of each one's mesh.
void add_spares(const Scene& scene, std::span<Mesh> meshes);

namespace cooking {

/// The triangles around a point, one after another in their winding order, as corners (3 triangle + corner); and the points on its rim:
/// triangle k lies between rim[k] and rim[k + 1]. One that is closed ends where it begins. A point that hangs together of several has
/// several.
struct Fan {
  std::vector<std::uint32_t> corners, rim;
  bool is_closed() const { return rim.size() == corners.size(); }
};
class Fans {
 public:
  explicit Fans(const Mesh& mesh);
  std::vector<Fan> of(std::uint32_t point) const;

 private:
  const Mesh& mesh_;
  std::vector<std::uint32_t> first_, corners_;   // by point
};

/// A cloth in a pose.
struct Posed {
  const Mesh& mesh;
  std::span<const Eigen::Vector3d> places;         // m, of its points
  std::function<bool(std::uint32_t)> is_held;      // points that never become two
};

/// Where it tears now: each point is split at most once, and none that a crack beside it has relieved. `limits`: as TearLists.
std::vector<Split> cracks(const Posed& cloth, std::span<const float> limits);

/// A blade: the part of a plane between two rays from one place.
struct Blade {
  Eigen::Vector3d origin, a, b;                    // m; directions
};

/// Along which points it goes, from one triangle that it meets to the next.
std::vector<Split> cut_by(const Posed& cloth, const Blade& blade);

}  // namespace cooking
}  // namespace weft
