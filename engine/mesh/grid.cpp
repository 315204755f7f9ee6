// Rectangular cloth as a grid. Every count and index is an integer expression of the two cell counts: a grid built by adding
// up a float step loses a row at some sizes.
#include <cassert>

#include "engine/mesh/parts.h"

namespace weft {
namespace {

/// The one place that knows how the grid's own x and y lie in space; (s, t) in 0 ... 1.
void add_vertex(Mesh& mesh, const Grid& grid, double s, double t) {
  const auto x = static_cast<float>((s - 0.5) * grid.size.x);
  const auto y = static_cast<float>((t - 0.5) * grid.size.y);
  mesh.render.positions.push_back(grid.upright ? Vec3{x, y, 0} : Vec3{x, 0, y});
  mesh.render.uvs.push_back({static_cast<float>(s), static_cast<float>(grid.upright ? 1 - t : t)});
}

}   // namespace

Mesh make_grid(const Grid& grid) {
  assert(grid.cells_x >= 1 && grid.cells_x <= 2048 && grid.cells_y >= 1 && grid.cells_y <= 2048);
  assert(grid.size.x > 0 && grid.size.y > 0);
  const std::uint32_t nx = grid.cells_x, ny = grid.cells_y;
  const bool centre = grid.topology == Topology::centre;
  const std::size_t corner_count = (std::size_t{nx} + 1) * (std::size_t{ny} + 1), cell_count = std::size_t{nx} * ny;
  const std::size_t vertex_count = corner_count + (centre ? cell_count : 0);

  Mesh mesh;
  RenderMesh& render = mesh.render;
  render.positions.reserve(vertex_count);
  render.uvs.reserve(vertex_count);
  for (std::uint32_t j = 0; j <= ny; ++j)
    for (std::uint32_t i = 0; i <= nx; ++i) add_vertex(mesh, grid, double(i) / nx, double(j) / ny);
  if (centre)
    for (std::uint32_t j = 0; j < ny; ++j)
      for (std::uint32_t i = 0; i < nx; ++i) add_vertex(mesh, grid, (i + 0.5) / nx, (j + 0.5) / ny);

  // Anticlockwise in (x, y) faces +z; (x, z) is a left-handed pair, so a flat grid's triangles run the other way to face +y.
  mesh.triangles.reserve(cell_count * (centre ? 4 : 2));
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.push_back(grid.upright ? Triangle{a, b, c} : Triangle{a, c, b});
  };
  for (std::uint32_t j = 0; j < ny; ++j)
    for (std::uint32_t i = 0; i < nx; ++i) {
      const std::uint32_t low_low = j * (nx + 1) + i, high_low = low_low + 1;
      const std::uint32_t low_high = low_low + nx + 1, high_high = low_high + 1;
      if (centre) {
        const std::uint32_t middle = static_cast<std::uint32_t>(corner_count) + j * nx + i;
        add(low_low, high_low, middle);
        add(high_low, high_high, middle);
        add(high_high, low_high, middle);
        add(low_high, low_low, middle);
      } else {
        add(low_low, high_low, high_high);
        add(low_low, high_high, low_high);
      }
    }
  render.triangles = mesh.triangles;
  render.normals.assign(vertex_count, grid.upright ? Vec3{0, 0, 1} : Vec3{0, 1, 0});
  render.tangents.assign(vertex_count, Vec4{1, 0, 0, 1});

  mesh.points = render.positions;
  mesh.point_of.resize(vertex_count);
  for (std::uint32_t v = 0; v < vertex_count; ++v) mesh.point_of[v] = v;
  mesh.point_of_source = mesh.point_of;
  mesh.edges = winged_edges(mesh.triangles, nullptr);
  mesh.weld_tolerance = parts::kWeldFraction * std::hypot(double(grid.size.x), double(grid.size.y));
  return mesh;
}

}   // namespace weft
