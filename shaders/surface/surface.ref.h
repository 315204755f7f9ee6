// Twin of surface: vertex normals as the mean of the triangles' normals, weighted by area (Gouraud 1971). The cross product
// of two sides is twice the area times the normal, so summing it up over all triangles of a point weighs by itself.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// One a point; +y where the triangles have no area or cancel out.
inline Points point_normals(const Points& x, std::span<const std::array<std::uint32_t, 3>> triangles) {
  Points normals(x.size(), Vector::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Vector doubled = (x[b] - x[a]).cross(x[c] - x[a]);
    for (const std::uint32_t i : {a, b, c}) normals[i] += doubled;
  }
  for (Vector& n : normals) n = n.norm() > 1e-20 ? n.normalized() : Vector::UnitY();
  return normals;
}

}  // namespace weft::reference
