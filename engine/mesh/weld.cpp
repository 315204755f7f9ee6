// From a render mesh to one that can be simulated: weld by position, then repair, and report every repair.
//
// Welding sorts vertices into cells so small that all vertices of a cell are welded (tolerance / sqrt(3) a side), and then
// compares cells up to two apart. Cells are sorted by one integer key, x slowest; the neighbours of a whole row of cells are
// then a run in the same list that only moves forward, so the search is linear and needs no hash. Points are the sets of a
// union-find that keeps the lowest vertex as the root: the result does not depend on the order in which pairs are found.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "engine/finite.h"
#include "engine/mesh/parts.h"

namespace weft {
namespace {

using Eigen::Vector3d;
using parts::wide;

class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    for (std::size_t i = 0; i < count; ++i) parent_[i] = static_cast<std::uint32_t>(i);
  }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

struct Box {
  Vector3d low = Vector3d::Constant(HUGE_VAL), high = Vector3d::Constant(-HUGE_VAL);
  void add(const Vector3d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  double diagonal() const { return (high - low).norm(); }
};

/// "1 triangle was", "3 triangles were".
std::string count_of(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

/// A vertex in the cell of that key.
struct Cell {
  std::uint64_t key;
  std::uint32_t vertex;
};

/// Whether a vertex of each list lies within the tolerance of one of the other; changes their order. Lists whose boxes cannot tell are
/// halved, so that crowds a little more than the tolerance apart do not cost every pair.
bool touch(std::span<const Vec3> positions, std::span<Cell> left, std::span<Cell> right, double tolerance) {
  const double squared_tolerance = tolerance * tolerance;
  const auto at = [&](const Cell& cell) { return wide(positions[cell.vertex]); };
  if (left.size() * right.size() <= 64)
    return std::ranges::any_of(left, [&](const Cell& l) {
      return std::ranges::any_of(right, [&](const Cell& r) { return (at(l) - at(r)).squaredNorm() <= squared_tolerance; });
    });
  Box l, r;
  for (const Cell& cell : left) l.add(at(cell));
  for (const Cell& cell : right) r.add(at(cell));
  if ((l.low - r.high).cwiseMax(r.low - l.high).cwiseMax(0).squaredNorm() > squared_tolerance) return false;   // the nearest they can be
  if ((l.high - r.low).cwiseMax(r.high - l.low).squaredNorm() <= squared_tolerance) return true;               // the farthest
  if (l.diagonal() < r.diagonal()) {
    std::swap(left, right);
    std::swap(l, r);
  }
  int axis = 0;
  (l.high - l.low).maxCoeff(&axis);
  const std::size_t half = left.size() / 2;
  std::ranges::nth_element(left, left.begin() + static_cast<std::ptrdiff_t>(half), {}, [&](const Cell& cell) { return at(cell)[axis]; });
  return touch(positions, left.first(half), right, tolerance) || touch(positions, left.subspan(half), right, tolerance);
}

/// For each vertex the lowest one that it is welded to. `used` vertices only; the others stay alone.
std::vector<std::uint32_t> weld(std::span<const Vec3> positions, const std::vector<std::uint8_t>& used, const Vector3d& low,
                                double tolerance) {
  // The diagonal is a million tolerances, so a coordinate is below sqrt(3) million cells: 21 bits, with two cells to spare on
  // either side.
  constexpr std::uint64_t x_step = std::uint64_t{1} << 42, y_step = std::uint64_t{1} << 21;
  const double cells_per_metre = std::numbers::sqrt3 / (tolerance * (1 - 1e-9));   // cells slightly smaller, to allow for rounding
  std::vector<Cell> cells;
  cells.reserve(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (!used[v]) continue;
    const Vector3d at = (wide(positions[v]) - low) * cells_per_metre;
    const auto part = [&](int axis) { return static_cast<std::uint64_t>(at[axis]) + 2; };
    cells.push_back({part(0) * x_step + part(1) * y_step + part(2), v});
  }
  std::sort(cells.begin(), cells.end(), [](const Cell& l, const Cell& r) { return l.key != r.key ? l.key < r.key : l.vertex < r.vertex; });

  Sets sets(positions.size());
  std::vector<std::size_t> start;   // of each occupied cell in `cells`, and the end
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i == 0 || cells[i].key != cells[i - 1].key)
      start.push_back(i);
    else
      sets.join(cells[i - 1].vertex, cells[i].vertex);
  }
  const std::size_t cell_count = start.size();
  start.push_back(cells.size());

  const auto weld_cells = [&](std::size_t left, std::size_t right) {
    const std::uint32_t l = cells[start[left]].vertex, r = cells[start[right]].vertex;
    const auto all_of = [&](std::size_t cell) { return std::span(cells).subspan(start[cell], start[cell + 1] - start[cell]); };
    if (sets.root(l) != sets.root(r) && touch(positions, all_of(left), all_of(right), tolerance)) sets.join(l, r);
  };
  for (int dx = 0; dx <= 2; ++dx)
    for (int dy = dx == 0 ? 0 : -2; dy <= 2; ++dy) {
      // Unsigned wrap-around is meant: only the sum of key and offset counts, and it is never negative.
      const std::uint64_t row =
          static_cast<std::uint64_t>(dx) * x_step + static_cast<std::uint64_t>(static_cast<std::int64_t>(dy)) * y_step;
      const bool own_row = dx == 0 && dy == 0;
      std::size_t first = 0;
      for (std::size_t c = 0; c < cell_count; ++c) {
        const std::uint64_t key = cells[start[c]].key + row;
        const std::uint64_t lowest = own_row ? key + 1 : key - 2;
        while (first < cell_count && cells[start[first]].key < lowest) ++first;
        for (std::size_t n = first; n < cell_count && cells[start[n]].key <= key + 2; ++n) weld_cells(c, n);
      }
    }

  std::vector<std::uint32_t> lowest(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) lowest[v] = sets.root(v);
  return lowest;
}

Result<void> check_lists(const RenderMesh& render) {
  const std::size_t count = render.positions.size();
  if (count > kMostVertices) return fail("the mesh has ", count, " vertices; at most ", kMostVertices, " are allowed");
  const auto fits = [&](std::size_t size) { return size == 0 || size == count; };
  if (!fits(render.normals.size()) || !fits(render.tangents.size()) || !fits(render.uvs.size()))
    return fail("the mesh has ", count, " positions but ", render.normals.size(), " normals, ", render.tangents.size(), " tangents and ",
                render.uvs.size(), " texture coordinates; each list is as long as the positions or empty");
  if (Result<void> checked = parts::check_places(render.positions); !checked) return checked;
  std::size_t bad = 0, first = 0;
  for (std::size_t t = render.triangles.size(); t-- > 0;)
    if (std::ranges::any_of(render.triangles[t], [&](std::uint32_t v) { return v >= count; })) {
      ++bad;
      first = t;
    }
  if (bad)
    return fail(bad, " of ", render.triangles.size(), " triangles ", bad == 1 ? "points" : "point", " past the last of ", count,
                " vertices, the first is triangle ", first);
  if (render.triangles.empty()) return fail("the mesh has no triangle");
  return parts::check_materials(render);
}

/// Leaves the triangles that have an area and are no duplicates; `lowest` is what weld returned.
void keep_sound_triangles(RenderMesh& render, std::span<const std::uint32_t> lowest, double diagonal, std::vector<std::string>& mended) {
  struct Key {
    Triangle sorted;
    std::uint32_t triangle;
    auto operator<=>(const Key&) const = default;
  };
  const double least_area = parts::kAreaFraction * diagonal * diagonal;
  std::vector<Key> keys;
  keys.reserve(render.triangles.size());
  for (std::uint32_t t = 0; t < render.triangles.size(); ++t) {
    Triangle points = render.triangles[t];
    for (std::uint32_t& p : points) p = lowest[p];
    const Vector3d origin = wide(render.positions[points[0]]);
    const double area = 0.5 * (wide(render.positions[points[1]]) - origin).cross(wide(render.positions[points[2]]) - origin).norm();
    if (points[0] == points[1] || points[1] == points[2] || points[2] == points[0] || !(area >= least_area)) continue;
    std::sort(points.begin(), points.end());
    keys.push_back({points, t});
  }
  if (const std::size_t flat = render.triangles.size() - keys.size())
    mended.push_back(count_of(flat, "triangle had", "triangles had") +
                     " no area (a repeated point, or less than 1e-12 of the squared diagonal) and " + (flat == 1 ? "was" : "were") +
                     " dropped");

  std::sort(keys.begin(), keys.end());
  const std::size_t before = keys.size();
  keys.erase(std::unique(keys.begin(), keys.end(), [](const Key& l, const Key& r) { return l.sorted == r.sorted; }), keys.end());
  if (const std::size_t copies = before - keys.size())
    mended.push_back(count_of(copies, "triangle lay", "triangles lay") + " on the same three points as an earlier one and " +
                     (copies == 1 ? "was" : "were") + " dropped");

  std::sort(keys.begin(), keys.end(), [](const Key& l, const Key& r) { return l.triangle < r.triangle; });
  for (std::size_t t = 0; t < keys.size(); ++t) {
    render.triangles[t] = render.triangles[keys[t].triangle];
    if (!render.material_of.empty()) render.material_of[t] = render.material_of[keys[t].triangle];
  }
  render.triangles.resize(keys.size());
  if (!render.material_of.empty()) render.material_of.resize(keys.size());
}

/// Drops vertices that no triangle has; returns the old index of each that stays.
std::vector<std::uint32_t> drop_unused(RenderMesh& render) {
  std::vector<std::uint32_t> renamed(render.positions.size(), kNone), old_index;
  for (const Triangle& t : render.triangles)
    for (const std::uint32_t v : t) renamed[v] = 0;
  for (std::uint32_t v = 0; v < renamed.size(); ++v)
    if (renamed[v] != kNone) {
      renamed[v] = static_cast<std::uint32_t>(old_index.size());
      old_index.push_back(v);
    }
  const auto compact = [&](auto& list) {
    if (list.empty()) return;
    for (std::size_t v = 0; v < old_index.size(); ++v) list[v] = list[old_index[v]];
    list.resize(old_index.size());
  };
  compact(render.positions);
  compact(render.normals);
  compact(render.tangents);
  compact(render.uvs);
  for (Triangle& t : render.triangles)
    for (std::uint32_t& v : t) v = renamed[v];
  return old_index;
}

void repair_winding(Mesh& mesh) {
  const parts::Orientation orientation = parts::orient(mesh.triangles);
  for (const std::uint32_t t : orientation.turn) {
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    std::swap(mesh.render.triangles[t][1], mesh.render.triangles[t][2]);
  }
  if (const std::size_t turned = orientation.turn.size()) {
    mesh.mended.push_back(count_of(turned, "triangle was", "triangles were") +
                          " wound against the neighbours and turned; normals were made anew");
    mesh.render.normals.clear();
    mesh.render.tangents.clear();
  }
  if (const std::uint32_t twisted = orientation.twisted_pieces)
    mesh.mended.push_back(count_of(twisted, "connected piece", "connected pieces") + " cannot be oriented, as a Moebius strip cannot");
}

}   // namespace

namespace parts {

Result<void> check_places(std::span<const Vec3> positions) {
  const std::size_t count = positions.size();
  std::size_t bad = 0, first = 0;
  for (std::size_t v = count; v-- > 0;)
    if (!parts::finite(positions[v])) {
      ++bad;
      first = v;
    }
  if (bad) return fail(bad, " of ", count, " vertices ", bad == 1 ? "is" : "are", " not finite, the first is vertex ", first);
  for (std::size_t v = count; v-- > 0;)
    if (!is_finite(positions[v])) {
      ++bad;
      first = v;
    }
  if (bad)
    return fail(bad, " of ", count, " vertices ", bad == 1 ? "lies" : "lie", " ", kTooLarge,
                " m or more from the origin, the first is vertex ", first, ", ", wide(positions[first]).norm(), " m away");
  return {};
}

void keep_loose(Mesh& mesh, std::span<const Vec3> source) {
  mesh.loose.clear();
  for (std::size_t v = 0; v < mesh.point_of_source.size(); ++v)
    if (mesh.point_of_source[v] == kNone) mesh.loose.push_back(source[v]);
}

}   // namespace parts

Result<Mesh> weld_mesh(RenderMesh render) try {
  if (Result<void> checked = check_lists(render); !checked) return checked.take_error();
  std::vector<std::uint8_t> used(render.positions.size(), 0);
  Box box;
  for (const Triangle& t : render.triangles)
    for (const std::uint32_t v : t) {
      used[v] = 1;
      box.add(wide(render.positions[v]));
    }
  const double diagonal = box.diagonal();
  if (!(diagonal > 0)) return fail("all ", render.triangles.size(), " triangles lie at one place; none has an area");

  Mesh mesh;
  mesh.weld_tolerance = parts::kWeldFraction * diagonal;
  const std::vector<std::uint32_t> lowest = weld(render.positions, used, box.low, mesh.weld_tolerance);
  const std::size_t triangle_count = render.triangles.size(), vertex_count = render.positions.size();
  keep_sound_triangles(render, lowest, diagonal, mesh.mended);
  if (render.triangles.empty()) return fail("none of the ", triangle_count, " triangles has an area");
  const std::vector<Vec3> source = render.positions;
  const std::vector<std::uint32_t> old_index = drop_unused(render);
  if (const std::size_t unused = vertex_count - old_index.size())
    mesh.mended.push_back(count_of(unused, "vertex", "vertices") + " belonged to no triangle (or to dropped ones) and " +
                          (unused == 1 ? "was" : "were") + " dropped");

  std::vector<std::uint32_t> point_at(vertex_count, kNone);   // by lowest welded vertex
  mesh.point_of_source.assign(vertex_count, kNone);
  mesh.point_of.reserve(old_index.size());
  for (std::size_t v = 0; v < old_index.size(); ++v) {
    std::uint32_t& point = point_at[lowest[old_index[v]]];
    if (point == kNone) {
      point = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back(render.positions[v]);
    }
    mesh.point_of.push_back(point);
    mesh.point_of_source[old_index[v]] = point;
  }
  parts::keep_loose(mesh, source);
  mesh.render = std::move(render);
  mesh.triangles.reserve(mesh.render.triangles.size());
  for (const Triangle& t : mesh.render.triangles) mesh.triangles.push_back({mesh.point_of[t[0]], mesh.point_of[t[1]], mesh.point_of[t[2]]});

  repair_winding(mesh);
  std::uint32_t non_manifold = 0;
  mesh.edges = winged_edges(mesh.triangles, &non_manifold);
  if (non_manifold)
    mesh.mended.push_back(count_of(non_manifold, "edge lies", "edges lie") +
                          " between more than two triangles or two that face opposite ways; two that fit stay neighbours, the others hang "
                          "on by their points");

  parts::complete_normals(mesh.render, mesh.point_of, mesh.points, mesh.triangles);
  parts::complete_uvs(mesh.render);
  parts::complete_tangents(mesh.render);
  return mesh;
} catch (...) {
  return caught("the mesh");
}

}   // namespace weft
