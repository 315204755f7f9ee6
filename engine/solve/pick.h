// What a ray meets of a surface of triangles, and what of it is nearest to a point. Double precision, no Vulkan.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/mesh.h"

namespace weft {

struct Hit {
  std::uint32_t triangle = 0;
  std::array<double, 3> weights{};   // barycentric, of its corners; none below 0
  double distance = 0;               // m, along the ray or from the point
};

/// The first triangle in front of `origin` that the ray goes through, from either side; of two at one distance the lower number. `direction` need
/// not be a unit vector, but is not 0. Triangles that are not finite or have no area meet no ray.
std::optional<Hit> first_on_ray(std::span<const Triangle> triangles, std::span<const Vec3> points, Vec3 origin, Vec3 direction);

/// The point that is nearest; nothing where no triangle is finite.
std::optional<Hit> nearest_to(std::span<const Triangle> triangles, std::span<const Vec3> points, Vec3 point);

}  // namespace weft
