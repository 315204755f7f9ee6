// Faces of more than three corners: their triangles cover them, whatever shape they have and way they lie.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "engine/mesh/parts.h"
#include "tests/support/mesh_files.h"

namespace weft {
namespace {

using Eigen::Vector3d;
using parts::wide;
using test::Folder;

Vector3d area_of(const Vector3d& a, const Vector3d& b, const Vector3d& c) { return 0.5 * (b - a).cross(c - a); }

/// Every triangle faces as the face does, and together they have its area, so none lies on another.
void expect_covered(const std::vector<Vec3>& face) {
  Vector3d whole = Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < face.size(); ++i) whole += area_of(wide(face[0]), wide(face[i]), wide(face[i + 1]));
  std::vector<Triangle> triangles;
  EXPECT_TRUE(parts::cut_face(face, triangles));
  ASSERT_EQ(triangles.size(), face.size() - 2);
  double sum = 0;
  std::set<std::uint32_t> corners;
  for (const Triangle& t : triangles) {
    const Vector3d area = area_of(wide(face[t[0]]), wide(face[t[1]]), wide(face[t[2]]));
    EXPECT_GT(area.dot(whole), -1e-6 * whole.squaredNorm());   // the corners were rounded when the face was turned
    sum += area.norm();
    corners.insert(t.begin(), t.end());
  }
  EXPECT_NEAR(sum / whole.norm(), 1, 1e-5);
  EXPECT_EQ(corners.size(), face.size());
}

/// The same face in several planes, both ways round, and from another corner on.
void expect_covered_everywhere(std::vector<Vec3> face) {
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(1, 1, 1), Vector3d(0.1, -2, 0.3)})
    for (const double angle : {0.0, 0.7, 1.5707963267948966, 3.0}) {
      const Eigen::AngleAxisd turn(angle, axis.normalized());
      std::vector<Vec3> turned;
      for (const Vec3 p : face) turned.push_back(parts::narrow(turn * wide(p)));
      expect_covered(turned);
      std::rotate(turned.begin(), turned.begin() + 2, turned.end());
      std::reverse(turned.begin(), turned.end());
      expect_covered(turned);
    }
}

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += area_of(wide(mesh.points[t[0]]), wide(mesh.points[t[1]]), wide(mesh.points[t[2]])).norm();
  return sum;
}

TEST(Polygon, a_concave_face_of_an_obj_has_its_own_area) {
  const Folder folder;
  for (const char* face : {"f 1 2 3 4 5\n", "f 4 5 1 2 3\n", "f 5 4 3 2 1\n", "f 3 2 1 5 4\n"}) {
    const Result<Mesh> mesh =
        load_mesh(folder.write("concave.obj", std::string("v 0 0 0\nv 4 0 0\nv 4 0 4\nv 3 0 1\nv 0 0 4\n") + face));
    ASSERT_TRUE(mesh) << mesh.error();
    EXPECT_EQ(mesh->triangles.size(), 3u);
    EXPECT_NEAR(area_of(*mesh), 10, 1e-5);
    EXPECT_TRUE(mesh->mended.empty()) << mesh->mended[0];
  }
}

TEST(Polygon, a_convex_quad_is_cut_from_its_first_corner) {
  std::vector<Triangle> triangles;
  EXPECT_TRUE(parts::cut_face(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, triangles));
  EXPECT_EQ(triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Polygon, an_arrow_a_comb_a_spiral_and_stars_are_covered) {
  expect_covered_everywhere({{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {1, 1, 0}});
  std::vector<Vec3> comb{{0, -1, 0}, {40, -1, 0}};
  for (int tooth = 20; tooth-- > 0;) {
    const auto x = static_cast<float>(2 * tooth);
    comb.insert(comb.end(), {{x + 1.5f, 0, 0}, {x + 1, 30, 0}, {x + 0.5f, 0, 0}});
  }
  expect_covered_everywhere(comb);
  std::vector<Vec3> spiral;
  for (const bool outwards : {true, false})
    for (int k = 0; k < 150; ++k) {
      const double angle = 0.1 * (outwards ? k : 149 - k), radius = (outwards ? 1 : 0.7) * (1 + angle);
      spiral.push_back({static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), 0});
    }
  expect_covered_everywhere(spiral);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> radius(0.1, 3);
  for (const int corners : {5, 8, 33, 333, 1000}) {
    std::vector<Vec3> star;
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * k / corners, r = radius(random);
      star.push_back({static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)), 0});
    }
    expect_covered(star);
  }
}

TEST(Polygon, corners_on_a_straight_line_stay_corners) {
  expect_covered({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}});
  expect_covered({{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1, 4, 0}, {0, 0, 0}});
  // The neighbour has a vertex on the long side; dropped there, the cloth would be open along it.
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(folder.write(
      "side.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 0 -1 0\nv 1 -1 0\nv 2 -1 0\nf 1 2 3 4 5\nf 6 7 2 1\nf 7 8 3 2\n"));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_TRUE(mesh->mended.empty()) << mesh->mended[0];
  EXPECT_EQ(mesh->points.size() + mesh->triangles.size(), mesh->edges.size() + 1);   // Euler: a disc
}

TEST(Polygon, a_face_with_a_hole_that_a_slit_reaches_is_covered) {
  expect_covered_everywhere(
      {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}, {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}});
}

TEST(Polygon, a_face_that_crosses_itself_or_has_no_area_is_counted) {
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(
      folder.write("crossed.obj", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1.5 0\nv 0 0 5\nv 1 0 5\nv 2 0 5\nv 3 0 5\nf 1 2 3 4\nf 5 6 7 8\n"));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->mended[0], "1 face crosses over itself; triangles of it lie on each other or face different ways");
  EXPECT_EQ(mesh->mended[1].substr(0, 26), "2 triangles had no area (a");
}

TEST(Polygon, more_corners_than_can_be_cut_are_refused_with_both_numbers) {
  const Folder folder;
  const auto disc = [&](std::uint32_t corners) {
    std::string text, face = "f";
    for (std::uint32_t k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * k / corners;
      text += "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
      face += " " + std::to_string(k + 1);
    }
    return load_mesh(folder.write("disc.obj", text + face + "\n"));
  };
  const Result<Mesh> most = disc(kMostCorners), more = disc(kMostCorners + 1), far_more = disc(24000);
  ASSERT_TRUE(most) << most.error();
  EXPECT_EQ(most->triangles.size(), kMostCorners - 2);
  ASSERT_FALSE(more || far_more);
  EXPECT_NE(more.error().find("line 1002: a face has 1001 corners; at most 1000 can be read"), std::string::npos) << more.error();
  EXPECT_NE(far_more.error().find("line 24001: a face has 24000 corners; at most 1000"), std::string::npos) << far_more.error();
}

}   // namespace
}   // namespace weft
