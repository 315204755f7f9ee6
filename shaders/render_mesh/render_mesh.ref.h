// Twin of render_mesh in double precision; it binds vertices, too.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "shaders/jacobi.ref.h"
#include "shaders/shared.h"

namespace weft::reference {

/// A triangle with its corners' normals (unit).
struct CurvedTriangle {
  std::array<Vector, 3> corners, normals;
};

struct CurvedPlace {
  Vector place;            // m
  Eigen::Matrix3d axes;    // columns: along the first side, across it, along the normal
};

inline Vector unit_or(const Vector& v, const Vector& otherwise) { return v.norm() > 1e-20 ? Vector(v.normalized()) : otherwise; }

/// The place that weights choose on a triangle curved by its normals (Boubekeur and Alexa 2008), and the axes there.
inline CurvedPlace place_on(const CurvedTriangle& t, const Vector& weights) {
  Vector flat = Vector::Zero(), normal = Vector::Zero(), curve = Vector::Zero();
  for (int k = 0; k < 3; ++k) flat += weights[k] * t.corners[k], normal += weights[k] * t.normals[k];
  for (int k = 0; k < 3; ++k) curve -= weights[k] * (flat - t.corners[k]).dot(t.normals[k]) * t.normals[k];
  const Vector up = unit_or(normal, t.normals[0]), side = t.corners[1] - t.corners[0];
  const Vector aside = std::abs(up.y()) < 0.9 ? Vector::UnitY() : Vector::UnitX();
  const Vector along = unit_or(side - side.dot(up) * up, aside.cross(up).normalized());
  CurvedPlace made;
  made.place = flat + double(WEFT_PHONG_CURVE) * curve;
  made.axes << along, up.cross(along), up;
  return made;
}

}  // namespace weft::reference
