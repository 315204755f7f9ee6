// Plain vectors for descriptions and meshes: three floats are three floats. Mathematics in double is done with Eigen in
// the sources; these types only carry values through public headers.
#pragma once

#include <cmath>
#include <cstdint>

namespace weft {

struct Vec2 {
  float x = 0, y = 0;
  bool operator==(const Vec2&) const = default;
};

struct Vec3 {
  float x = 0, y = 0, z = 0;
  bool operator==(const Vec3&) const = default;
};

struct Vec4 {
  float x = 0, y = 0, z = 0, w = 0;
  bool operator==(const Vec4&) const = default;
};

/// A rotation as a unit quaternion, the real part last.
struct Rotation {
  float x = 0, y = 0, z = 0, w = 1;
  bool operator==(const Rotation&) const = default;
};

/// An affine map of space: p goes to p.x x + p.y y + p.z z + origin.
struct Affine {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};   // where the axes' unit vectors go
  Vec3 origin;                               // m, where the origin goes
  bool operator==(const Affine&) const = default;
};

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(float s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline float length(Vec3 a) { return std::sqrt(dot(a, a)); }
/// The linear part alone.
inline Vec3 turned(const Affine& m, Vec3 v) { return v.x * m.x + v.y * m.y + v.z * m.z; }
inline Vec3 operator*(const Affine& m, Vec3 p) { return turned(m, p) + m.origin; }
/// First b, then a.
inline Affine operator*(const Affine& a, const Affine& b) { return {turned(a, b.x), turned(a, b.y), turned(a, b.z), a * b.origin}; }

}  // namespace weft
