// The pass render_mesh against its twin.
#include <gtest/gtest.h>

#include "engine/effects/render_mesh/render_mesh.h"
#include "shaders/render_mesh/render_mesh.ref.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using KernelRenderMesh = GpuTest;

// Particles anywhere, one triangle of no size and one whose normals cancel; vertices with any weights and offsets.
TEST_F(KernelRenderMesh, does_what_its_twin_does) {
  Random random(11);
  for (const bool storage : {false, true}) {
    Scene scene = sheet(9);
    scene.cloths[0].render_mesh = "any";
    std::vector<Mesh> meshes = must(make_meshes(sheet(9)));
    meshes.push_back(make_grid({{1, 1}, 20, 20, Topology::diagonal, false}));
    CookedFabric fabric = must(cook(scene, meshes));
    auto& carried = fabric.own.of<RenderMeshLists>().carried;
    ASSERT_EQ(carried.size(), 21u * 21);
    for (gpu::Carried& bound : carried) {
      for (float& w : bound.weights) w = static_cast<float>(between(random, 0, 0.5));
      bound.offset = {static_cast<float>(between(random, -1, 1)), static_cast<float>(between(random, -1, 1)), 0.5f};
    }
    for (std::uint32_t& corner : carried[7].corners) corner = 3;
    const std::uint32_t drawn = drawn_vertices(fabric), own = fabric.cloths[0].vertices;
    ASSERT_EQ(drawn, 100u + 441);
    std::vector<gpu::vec4> positions, normals;
    for (std::uint32_t v = 0; v < drawn; ++v) {
      positions.push_back(anywhere(random, 1, 1));
      gpu::vec4 n = anywhere(random, 1, 0);
      const float size = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
      normals.push_back({n.x / size, n.y / size, n.z / size, 0});
    }
    for (std::uint32_t v = 0; v < 3; ++v) normals[carried[9].corners[v]] = v == 0 ? gpu::vec4{0, 1, 0, 0} : gpu::vec4{1, 0, 0, 0};

    SinglePass passes(device(), scene, fabric, storage);
    passes.begin(frame_of(1));
    passes.put(buffers::vertex_positions, positions);
    passes.put(buffers::vertex_normals, normals);
    passes.run("render_mesh");
    const auto placed = passes.get<gpu::vec4>(buffers::vertex_positions, drawn);
    const auto turned = passes.get<gpu::vec4>(buffers::vertex_normals, drawn);
    for (std::uint32_t v = 0; v < own; ++v) EXPECT_EQ(placed[v].x, positions[v].x) << "the cloth's own vertices stay";
    for (const gpu::Carried& bound : carried) {
      SCOPED_TRACE(bound.vertex);
      reference::CurvedTriangle t;
      for (int k = 0; k < 3; ++k) t.corners[k] = vector(positions[bound.corners[k]]), t.normals[k] = vector(normals[bound.corners[k]]);
      const reference::Vector weights(bound.weights[0], bound.weights[1], 1.0 - bound.weights[0] - bound.weights[1]);
      const auto place = reference::place_on(t, weights);
      const reference::Vector up = weights[0] * t.normals[0] + weights[1] * t.normals[1] + weights[2] * t.normals[2];
      const reference::Vector side = t.corners[1] - t.corners[0], along = side - side.dot(up.normalized()) * up.normalized();
      // Axes that hang on what is short turn far by rounding.
      const double sure = std::min({1.0, up.norm(), along.norm() > 0 ? along.norm() : 1.0});
      EXPECT_LT((vector(placed[bound.vertex]) - (place.place + place.axes * vector(bound.offset))).norm(), 100 * kRounding / (sure * sure));
      EXPECT_LT((vector(turned[bound.vertex]) - place.axes * vector(bound.normal)).norm(), 100 * kRounding / (sure * sure));
    }
  }
}

}  // namespace
}  // namespace weft
