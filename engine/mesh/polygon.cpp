// Faces of many corners, cut into triangles by their ears (Meisters 1975), as Eberly describes it (Triangulation by ear clipping,
// 2002): an ear that is cut changes nobody but its two neighbours, so every corner is looked at a few times only, each time against
// the corners that are not sharp then. A convex face is cut in linear time, the worst in quadratic.
//
// mapbox's earcut leaves out corners that lie on a straight line. Here every corner is kept: the neighbour's
// vertices lie there, and the cloth would open along the line.
#include <array>

#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A face in its plane, anticlockwise, and what is left of it.
class Polygon {
 public:
  explicit Polygon(std::span<const Vec3> face) : size_(static_cast<std::uint32_t>(face.size())) {
    Vector3d normal = Vector3d::Zero();   // Newell's: the face need not be flat
    const Vector3d origin = wide(face[0]);
    for (std::size_t i = 1; i + 1 < face.size(); ++i) normal += (wide(face[i]) - origin).cross(wide(face[i + 1]) - origin);
    int axis = 0;   // along which the face is looked at
    normal.cwiseAbs().maxCoeff(&axis);
    for (const Vec3 corner : face) {
      const Vector3d p = wide(corner);
      const double x = p[(axis + 1) % 3], y = p[(axis + 2) % 3];
      at_.push_back(normal[axis] < 0 ? Vector2d(y, x) : Vector2d(x, y));
    }
    for (std::uint32_t i = 0; i < size_; ++i) {
      before_.push_back((i + size_ - 1) % size_);
      after_.push_back((i + 1) % size_);
    }
    for (std::uint32_t i = 0; i < size_; ++i)
      if (!(turn(before_[i], i, after_[i]) > 0)) blunt_.push_back(i);
  }

  bool cut(std::vector<Triangle>& triangles) {
    std::vector<std::uint32_t> waiting;
    for (std::uint32_t i = 1; i <= size_; ++i) waiting.push_back(i % size_);   // a convex face becomes a fan about its first corner
    std::uint32_t left = size_;
    for (std::size_t next = 0; next < waiting.size() && left > 3; ++next) {
      const std::uint32_t i = waiting[next];
      if (gone_[i] || !is_ear(i)) continue;
      const std::uint32_t a = before_[i], b = after_[i];
      triangles.push_back({a, i, b});
      gone_[i] = 1;
      after_[a] = b;
      before_[b] = a;
      --left;
      std::erase_if(blunt_, [&](std::uint32_t q) { return (q == a || q == b) && turn(before_[q], q, after_[q]) > 0; });
      waiting.push_back(a);
      waiting.push_back(b);
    }
    // One triangle, or what has no ear: that crosses itself, or has no area.
    std::uint32_t first = 0;
    while (gone_[first]) ++first;
    bool covered = true;
    for (std::uint32_t i = after_[first]; after_[i] != first; i = after_[i]) {
      triangles.push_back({first, i, after_[i]});
      covered &= !(turn(first, i, after_[i]) < 0);
    }
    return covered;
  }

 private:
  /// Twice the area of a triangle, above 0 when it runs anticlockwise.
  double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vector2d ab = at_[b] - at_[a], ac = at_[c] - at_[a];
    return ab.x() * ac.y() - ab.y() * ac.x();
  }

  /// Sharp, and with no other corner inside or on its border; one at the place of its own corners, as on both sides of a slit,
  /// does not count.
  bool is_ear(std::uint32_t i) const {
    const std::uint32_t a = before_[i], b = after_[i];
    if (!(turn(a, i, b) > 0)) return false;
    for (const std::uint32_t q : blunt_)
      if (turn(a, i, q) >= 0 && turn(i, b, q) >= 0 && turn(b, a, q) >= 0 && at_[q] != at_[a] && at_[q] != at_[i] &&
          at_[q] != at_[b])
        return false;
    return true;
  }

  std::uint32_t size_;
  std::vector<Vector2d> at_;
  std::vector<std::uint32_t> before_, after_, blunt_;   // blunt: half a turn or more; only such corners can lie in an ear
  std::vector<std::uint8_t> gone_ = std::vector<std::uint8_t>(size_, 0);
};

}   // namespace

bool cut_face(std::span<const Vec3> face, std::vector<Triangle>& triangles) { return Polygon(face).cut(triangles); }

}   // namespace weft::parts
