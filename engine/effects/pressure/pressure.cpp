// The gas in closed cloth: which meshes can hold one, and its lists. shaders/pressure/gas.glsl has the physics.
#include "engine/effects/pressure/pressure.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

using Eigen::Vector3d;

constexpr const Buffer* kBuffers[] = {&buffers::gases,       &buffers::gas_parts,  &buffers::gas_rows,      &buffers::gas_rings,
                                      &buffers::gas_amounts, &buffers::gas_states, &buffers::gas_gradients, &buffers::gas_sums};

constexpr Pass kPasses[] = {
    {.name = "pressure_volume", .stage = Stage::force, .threads = {lengths::gas_parts}, .a_workgroup_each = true},
    {.name = "pressure", .stage = Stage::force, .threads = {lengths::gas_parts}, .changes = Changes::velocity, .a_workgroup_each = true},
};

// Of the mean edge: further out in one substep, a triangle could turn over before its links have had a say.
constexpr double kMostOfEdge = 0.5;

// Of the volume of a layer as thick as the mesh's edges are long: what is less is rounding.
constexpr double kLeastVolume = 1e-6;

// At a point: a thread goes through all of them, and ends without a word after WEFT_MOST_TURNS.
constexpr std::size_t kMostTriangles = 65536;

std::string edges(std::size_t count, std::size_t all) {
  return fail(count, count == 1 ? " edge of " : " edges of ", all).message;
}

// Errors: why the mesh holds no gas.
Result<void> check_closed(const Mesh& mesh) {
  struct Side {
    std::uint32_t low, high;
    bool down;   // from the higher to the lower
    auto operator<=>(const Side&) const = default;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), a > b});
    }
  std::ranges::sort(sides);
  std::size_t all = 0, open = 0, crowded = 0, twisted = 0;
  for (std::size_t k = 0; k < sides.size();) {
    std::size_t end = k, down = 0;
    for (; end < sides.size() && sides[end].low == sides[k].low && sides[end].high == sides[k].high; ++end) down += sides[end].down;
    ++all;
    open += end - k == 1;
    crowded += end - k > 2;
    twisted += end - k == 2 && down != 1;
    k = end;
  }
  if (open > 0)
    return fail("pressure: the mesh is not closed and would not hold a gas: it has a triangle on one side only at ", edges(open, all));
  if (crowded > 0)
    return fail("pressure: the mesh has no inside that could hold a gas: three triangles or more meet at ", edges(crowded, all));
  if (twisted > 0)
    return fail("pressure: the mesh's triangles are not wound alike, so that it has no inside: they run the same way at ",
                edges(twisted, all));
  return {};
}

struct Shape {
  double volume = 0, area = 0, edge = 0;   // m^3, m^2; m: the mean
};
Shape shape_of(const Mesh& mesh) {
  Shape shape;
  for (const Triangle& t : mesh.triangles) {
    const Vector3d origin = cooking::vector(mesh.points[0]);
    const Vector3d a = cooking::vector(mesh.points[t[0]]) - origin, b = cooking::vector(mesh.points[t[1]]) - origin,
                   c = cooking::vector(mesh.points[t[2]]) - origin;
    shape.volume += a.dot(b.cross(c)) / 6;
    shape.area += (b - a).cross(c - a).norm() / 2;
    shape.edge += ((b - a).norm() + (c - b).norm() + (a - c).norm()) / (3 * static_cast<double>(mesh.triangles.size()));
  }
  return shape;
}

struct Corner {
  std::uint32_t from, to;   // of a triangle's other two particles, in winding order
};

// `corners` of one particle of a closed mesh: no two have the same `from`, nor the same `to`.
std::vector<std::uint32_t> ring_of(std::vector<Corner> corners) {
  std::ranges::sort(corners, {}, &Corner::from);
  std::vector<bool> passed(corners.size());
  std::vector<std::uint32_t> ring, firsts;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (passed[k]) continue;
    firsts.push_back(corners[k].from);
    ring.push_back(corners[k].from);
    for (std::size_t at = k; !passed[at];) {
      passed[at] = true;
      ring.push_back(corners[at].to);
      at = static_cast<std::size_t>(std::ranges::lower_bound(corners, corners[at].to, {}, &Corner::from) - corners.begin());
    }
  }
  for (std::size_t k = firsts.size(); k-- > 1;) ring.push_back(firsts[k - 1]);
  return ring;
}

gpu::Gas gas_of(const Gas& gas, const Shape& shape) {
  gpu::Gas made{};
  made.volume = static_cast<float>(gas.volume.value_or(shape.volume));
  made.pressure = static_cast<float>(gas.ambient + gas.rest_pressure);
  made.ambient = static_cast<float>(gas.ambient);
  made.most = static_cast<float>(kMostOfEdge * shape.edge);
  return made;
}

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  if (!input.cloth.pressure) return {};
  const Mesh& mesh = input.mesh;
  if (auto closed = check_closed(mesh); !closed) return closed;
  const Shape shape = shape_of(mesh);
  const double least = kLeastVolume * shape.area * shape.edge;
  if (shape.volume < -least)
    return fail("pressure: the mesh is inside out: its triangles face inwards, about ", -shape.volume, " m^3; wind them the other way");
  if (!(shape.volume > least)) return fail("pressure: the mesh encloses ", shape.volume, " m^3: there is no room for a gas in it");
  const auto particle_of = state.particle_of();
  const ClothRange& range = state.fabric().cloths.back();
  std::vector<std::vector<Corner>> corners(range.particles);
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint32_t i = particle_of[a], j = particle_of[b], k = particle_of[c];
    corners[i - range.first_particle].push_back({j, k});
    corners[j - range.first_particle].push_back({k, i});
    corners[k - range.first_particle].push_back({i, j});
  }
  auto& lists = state.fabric().own.of<GasLists>();
  gpu::Gas gas = gas_of(*input.cloth.pressure, shape);
  gas.cloth = static_cast<std::uint32_t>(state.fabric().cloths.size() - 1);
  gas.particle = range.first_particle;
  lists.gases.push_back(gas);
  for (std::vector<Corner>& around : corners) {
    if (around.size() >= kMostTriangles)
      return fail("pressure: ", around.size(), " triangles meet in a point, not fewer than ", kMostTriangles);
    std::vector<std::uint32_t> ring = ring_of(std::move(around));
    if (ring.empty()) ring.push_back(range.first_particle);   // of no triangle
    while (ring.size() % 4 != 0) ring.push_back(ring.back());
    lists.rows.push_back({static_cast<std::uint32_t>(lists.rings.size()), static_cast<std::uint32_t>(ring.size() / 4)});
    for (std::size_t k = 0; k < ring.size(); k += 4) lists.rings.push_back({ring[k], ring[k + 1], ring[k + 2], ring[k + 3]});
  }
  return {};
}

// Parts of one size, large enough that every gas has few: each workgroup adds up what those of its gas have found.
void lay_out(cooking::CookState& state) {
  auto& lists = state.fabric().own.of<GasLists>();
  constexpr std::size_t kAll = std::size_t(WEFT_GAS_PART) * WEFT_GAS_PARTS;
  const auto size = static_cast<std::uint32_t>(WEFT_GAS_PART * std::max<std::size_t>(1, (lists.rows.size() + kAll - 1) / kAll));
  std::uint32_t row = 0;
  for (std::uint32_t k = 0; k < lists.gases.size(); ++k) {
    gpu::Gas& gas = lists.gases[k];
    const std::uint32_t particles = state.fabric().cloths[gas.cloth].particles;
    gas.first_part = static_cast<std::uint32_t>(lists.parts.size());
    for (std::uint32_t first = 0; first < particles; first += size)
      lists.parts.push_back({k, row + first, gas.particle + first, std::min(size, particles - first)});
    gas.parts = static_cast<std::uint32_t>(lists.parts.size()) - gas.first_part;
    row += particles;
  }
}

}  // namespace

constinit const Effect pressure{
    .name = "pressure",
    .key = "pressure",
    .called_for = [](const Scene& scene, const CookedFabric&) {
      return std::ranges::any_of(scene.cloths, [](const Cloth& cloth) { return cloth.pressure.has_value(); });
    },
    .buffers = kBuffers,
    .passes = kPasses,
    .reference = Reference::absent,
    .cook = cook,
    .lay_out = lay_out,
};

}  // namespace weft::effects
