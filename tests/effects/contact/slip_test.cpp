// Cloth that is pulled off a body with ears: tethers, which know nothing of bodies, must not hold it there.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "engine/reference/intersections.h"
#include "tests/support/mesh_files.h"
#include "tests/support/sheets.h"

namespace weft {
namespace {

using Slip = GpuTest;

// Adds an ellipsoid to an OBJ of which `count` vertices are there, its rows from pole to pole; its points lean by `lean` m along x
// per metre of height.
void add_ellipsoid(std::ostream& obj, int& count, Vec3 centre, Vec3 radii, int rows, int columns, double lean) {
  const auto put = [&](double across, double along, double up) {
    const double y = radii.y * up;
    obj << "v " << centre.x + radii.x * across + lean * y << ' ' << centre.y + y << ' ' << centre.z + radii.z * along << '\n';
  };
  put(0, 0, 1);
  for (int i = 1; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double down = std::numbers::pi * i / rows, around = 2 * std::numbers::pi * j / columns;
      put(std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), std::cos(down));
    }
  put(0, 0, -1);
  const int first = count + 1, last = first + 1 + (rows - 1) * columns;
  const auto at = [&](int i, int j) { return i == 0 ? first : i == rows ? last : first + 1 + (i - 1) * columns + j % columns; };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      if (i > 0) obj << "f " << at(i, j) << ' ' << at(i, j + 1) << ' ' << at(i + 1, j) << '\n';
      if (i + 1 < rows) obj << "f " << at(i, j + 1) << ' ' << at(i + 1, j + 1) << ' ' << at(i + 1, j) << '\n';
    }
  count = last;
}

// A sheet of 1 m above a head of 0.2 m, whose two ears lean the way in which the sheet's hem is pulled, so that nothing but the engine
// could keep it from slipping off, after it has been laid over the head. Nothing rubs.
Scene pulled_off_a_head(const test::Folder& folder, std::uint32_t cells, double speed) {
  std::ostringstream obj;
  int count = 0;
  add_ellipsoid(obj, count, {0, 0.25f, 0}, {0.2f, 0.2f, 0.2f}, 16, 24, 0);
  for (const float z : {0.08f, -0.08f}) add_ellipsoid(obj, count, {-0.02f, 0.45f, z}, {0.03f, 0.15f, 0.03f}, 12, 12, 0.6);
  folder.write("head.obj", obj.str());
  Scene scene;
  scene.folder = folder / "";
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, cells, cells, Topology::diagonal, false};
  cloth.transform.translate = {0, 0.63f, 0};
  cloth.fabric.friction = 0;
  Anchor& hem = cloth.anchors.emplace_back();
  hem.box = Anchor::Box{{0.499f, -9, -9}, {0.501f, 9, 9}};
  hem.keys.resize(3);
  hem.keys[1] = {1, {-0.05f, -0.35f, 0}};
  hem.keys[2] = {1 + 3 / speed, {2.95f, -0.35f, 0}};
  Collider& head = scene.colliders.emplace_back();
  head.shape = ColliderShape::mesh;
  head.mesh = "head.obj";
  head.friction = 0;
  scene.colliders.push_back(plane(0));
  scene.contacts.enabled = true;
  return scene;
}

// Before tethers left it to what leads around, it hooked, for ever: 258 % in the mean. Later it still did, with 31 to 33 cells at 3 m/s: pairs
// into which the solve alone pulled cloth had no contact, and a step that they cut short loses what leads around, too (contact_prepare).
// Then one size in ten did, those below among them, while tethers took twice as much of the displacement bound (tether.glsl). With 20 cells
// its hem waited for a crease of the sheet that nobody pressed flat, up to the kinematic lag limit, and was driven through it (slide.glsl).
// At 5 m/s it snaps off the ears and comes after its hem at 10: with ten substeps it is chance whether the hem is driven through it.
TEST_F(Slip, a_sheet_slips_off_a_head_with_ears_and_crosses_neither_it_nor_itself) {
  const test::Folder folder;
  struct Pull {
    std::uint32_t cells;
    double speed;
    std::uint32_t substeps, seed;
  };
  for (const auto& [cells, speed, substeps, seed] : {Pull{32, 3, 10, 1}, Pull{37, 3, 10, 1}, Pull{29, 5, 10, 1}, Pull{20, 3, 10, 1},
                                                     Pull{32, 3, 10, 2}, Pull{29, 5, 20, 2}}) {
    SCOPED_TRACE(std::to_string(cells) + " cells, m/s: " + std::to_string(speed) + ", seed " + std::to_string(seed));
    Scene scene = pulled_off_a_head(folder, cells, speed);
    scene.solver.substeps = substeps;
    scene.cloths[0].start.seed = seed;
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 2.5);
    EXPECT_LT(strain_of(*simulation).mean, 0.02);
    float last = INFINITY;
    std::vector<Vec3> places;
    for (const gpu::vec4& p : must(simulation->read_positions())) places.push_back({p.x, p.y, p.z});
    const CookedFabric& fabric = simulation->fabric();
    for (const Vec3 p : std::span(places).first(cloth_particles(fabric))) last = std::min(last, p.x);
    EXPECT_GT(last, 0.3f) << "all of it is past the head";
    EXPECT_EQ(count_crossings(places, fabric.triangles, fabric.cloth_triangles), 0u);
    EXPECT_EQ(simulation->counts().non_finite, 0u);
  }
}

}  // namespace
}  // namespace weft
