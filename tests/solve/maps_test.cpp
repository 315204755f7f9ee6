// Cloth that varies by maps, as a host sees it: what a map says everywhere is what the fabric says, and what it says in places holds there.
#include <gtest/gtest.h>

#include "tests/support/every_method.h"
#include "tests/support/sheets.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using MapCase = GpuTest;

struct Mapped {
  Scene scene = without_contacts();
  std::vector<Mesh> meshes;
  explicit Mapped(const Scene& described) : scene(described), meshes(must(make_meshes(described))) {}
  // An attribute "_X", of each point.
  template <class Value>
  void paint(const Value& value) {
    auto& values = meshes[0].attributes["_X"];
    values.clear();
    for (const Vec3& x : meshes[0].points) values.push_back({value(x), 0, 0, 1});
  }
};

// Over a ball, with another fabric, and with a map that makes it that fabric: the same bits, by two methods, with contacts and without.
TEST_F(MapCase, a_figure_times_a_map_is_the_figure) {
  for (const bool contacts : {false, true})
    for (const Method method : {Method::by_default, Method::gauss_seidel}) {
      Scene scene = sheet(12);
      scene.colliders = {sphere({0.1f, -0.3f, 0}, 0.25), plane(-0.5f)};
      scene.contacts.enabled = contacts;
      scene.solver.method = method;
      Fabric& fabric = scene.cloths[0].fabric;
      fabric.stretch = 4000, fabric.shear = 16, fabric.bend = 4e-5;
      fabric.area_density = 0.25, fabric.friction = 0.5, fabric.thickness = 0.004;
      const auto plain = must(Simulation::create(device(), scene));
      Mapped mapped(scene);
      Fabric& halved = mapped.scene.cloths[0].fabric;
      halved.stretch *= 0.5, halved.shear *= 0.5, halved.bend *= 0.5;
      halved.area_density *= 0.5, halved.friction *= 0.5, halved.thickness *= 0.5;
      mapped.scene.cloths[0].start.imperfection *= 2;   // a fraction of the fabric's thickness
      mapped.scene.cloths[0].maps = {"_X", "_X", "_X", "_X", "_X"};
      mapped.paint([](Vec3) { return 2.0f; });
      const auto simulation = must(Simulation::create(device(), mapped.scene, mapped.meshes));
      run(*plain, 0.7);
      run(*simulation, 0.7);
      EXPECT_EQ(hash_of(*plain), hash_of(*simulation)) << "method " << int(method) << (contacts ? ", contacts" : "");
    }
}

// Two cloths, one of several materials that differ in what nothing here asks for: each knows which it is, by every method.
TEST_F(MapCase, a_map_of_what_nothing_touches_changes_no_bit) {
  for (const Method method : {Method::by_default, Method::implicit}) {
    Scene scene = sheet(8);
    scene.solver.method = method;
    scene.cloths[0].start.velocity = {1, 0, 2};
    scene.cloths.push_back(scene.cloths[0]);
    scene.cloths[1].start.velocity = {-3, 1, 0};
    scene.cloths[1].transform.translate = {0, 0, 5};
    const auto plain = must(Simulation::create(device(), scene));
    Mapped mapped(scene);
    mapped.scene.cloths[0].maps.friction = "_X";
    mapped.paint([](Vec3 x) { return x.x + 1; });
    const auto simulation = must(Simulation::create(device(), mapped.scene, mapped.meshes));
    ASSERT_GT(simulation->fabric().materials.size(), 5u);
    run(*plain, 0.3);
    run(*simulation, 0.3);
    EXPECT_EQ(hash_of(*plain), hash_of(*simulation)) << "method " << int(method);
  }
}

// A strip of 1 m, hung by its top, whose lower half is a quarter as stiff: by rho g L^2 / 2 Y, 3 m g of tension in the upper half's mean
// and m g in the lower's, which gives way four times as much. Far links of eight edges, and coarse ones, cross the middle: they blur it.
TEST_F(MapCase, a_softer_half_gives_way_as_much_as_it_is_softer) {
  for (const std::optional<bool> levels : {std::optional(false), std::optional(true)}) {
    Scene scene = sheet(4);
    scene.cloths[0].grid = Grid{{0.1f, 1}, 2, 40, Topology::diagonal, true};
    scene.cloths[0].fabric.stretch = scene.cloths[0].fabric.shear = 20;
    scene.cloths[0].fabric.damping = 8;
    scene.cloths[0].tethers = false;
    scene.cloths[0].anchors.emplace_back().top = 0.001;
    scene.solver.iterations = 10;
    scene.solver.method = Method::gauss_seidel;   // Jacobi has not converged by then
    scene.solver.levels = levels;
    Mapped mapped(scene);
    mapped.scene.cloths[0].maps.stretch = "_X";
    mapped.paint([](Vec3 x) { return x.y > 0.001f ? 1.0f : x.y < -0.001f ? 0.25f : 0.625f; });
    const auto simulation = must(Simulation::create(device(), mapped.scene, mapped.meshes));
    run(*simulation, 4);
    double middle = 0, low = 0;
    const auto rest = mapped.meshes[0].points;
    const auto now = must(simulation->read_vertex_positions());
    for (std::size_t v = 0; v < now.size(); ++v) {
      const Vec3 at = rest[mapped.meshes[0].point_of[v]];
      if (std::abs(at.y) < 1e-3f) middle = now[v].y;
      if (at.y < -0.499f) low = now[v].y;
    }
    const double upper = 0.5 - middle - 0.5, lower = middle - low - 0.5;
    EXPECT_NEAR(lower / upper, 4.0 / 3, 0.2) << "levels " << *levels;
    EXPECT_GT(upper, 0.01);
  }
}

// Of a sheet on an incline one half is rough and holds, the other smooth; they are not joined.
TEST_F(MapCase, what_is_smooth_slides_and_what_is_rough_stays) {
  Scene scene = sheet(10);
  scene.cloths[0].grid->size = {0.3f, 0.3f};
  scene.cloths[0].fabric.friction = 1;
  Collider incline = plane(-0.003f, 1);
  incline.normal = {0.5f, 0.8660254f, 0};
  scene.colliders = {incline};
  scene.cloths[0].transform.axis = {0, 0, 1};
  scene.cloths[0].transform.degrees = -30;
  scene.cloths.push_back(scene.cloths[0]);
  Mapped mapped(scene);
  mapped.scene.cloths[0].maps.friction = "_X";
  mapped.paint([](Vec3) { return 0.0f; });
  const auto simulation = must(Simulation::create(device(), mapped.scene, mapped.meshes));
  run(*simulation, 1);
  const auto positions = must(simulation->read_positions());
  const auto moved = [&](const ClothRange& cloth) {
    double sum = 0;
    for (std::uint32_t i = cloth.first_particle; i < cloth.first_particle + cloth.particles; ++i)
      sum += (double(positions[i].x) - simulation->fabric().positions[i].x) / cloth.particles;
    return sum;
  };
  EXPECT_NEAR(moved(simulation->fabric().cloths[0]), 0.5 * 9.81 * 0.5 * 0.8660254, 0.1);
  EXPECT_NEAR(moved(simulation->fabric().cloths[1]), 0, 0.01);
}

// Thicker than its cells are wide, in two thicknesses: a cloth of several materials is one cloth, and does not push itself apart.
TEST_F(MapCase, cloth_of_two_thicknesses_lies_flat_with_contacts) {
  Scene scene = sheet(20);
  scene.cloths[0].grid->size = {0.2f, 0.2f};
  scene.cloths[0].fabric.thickness = 0.02;
  scene.cloths[0].fabric.damping = 4;
  scene.cloths[0].transform.translate = {0, 0.021f, 0};
  scene.colliders = {plane(0)};
  scene.contacts.enabled = true;
  Mapped mapped(scene);
  mapped.scene.cloths[0].maps.thickness = "_X";
  int k = 0;
  mapped.paint([&](Vec3) { return ++k % 2 == 0 ? 1.0f : 0.98f; });
  const auto simulation = must(Simulation::create(device(), mapped.scene, mapped.meshes));
  run(*simulation, 0.5);
  EXPECT_LT(strain_of(*simulation).max, 0.01);
  for (const gpu::vec4& x : must(simulation->read_positions())) EXPECT_NEAR(x.y, 0.02, 0.002);
}

// Pinned by how firmly: a max distance of 0, and a stiffness from 0 to 1 along a strip that hangs.
TEST_F(MapCase, a_stiffness_map_says_how_firmly_vertices_are_held) {
  Scene scene = sheet(4);
  scene.cloths[0].grid = Grid{{1, 0.1f}, 20, 2, Topology::diagonal, false};
  scene.cloths[0].motion_constraints = MotionConstraints{.max_distance = 0, .stiffness_map = "_X"};
  Mapped mapped(scene);
  mapped.paint([](Vec3 x) { return x.x > 0.2f ? 0.0f : x.x < -0.2f ? 1.0f : 0.5f; });
  const auto simulation = must(Simulation::create(device(), mapped.scene, mapped.meshes));
  run(*simulation, 0.5);
  for (const gpu::vec4& x : must(simulation->read_positions())) {
    if (x.x < -0.25f) { EXPECT_NEAR(x.y, 0, 1e-5); }
    if (x.x > 0.45f) { EXPECT_LT(x.y, -0.02); }
  }
}

}  // namespace
}  // namespace weft
