// Which levels a cloth has, what their nodes weigh and how stiff their links are.
//
// A link of a level stands for the strip of cloth between its nodes, and only pulls, for cloth can always be nearer in space than along
// itself. It has the modulus of its direction (engine/effects/stretch/links.cpp) over four times the area that is its, as the mesh's
// links are four families, of the warp, the weft and both diagonals. Stretched evenly, cloth must pull as hard as without levels. So
// all levels together get half of the stiffness, in equal parts, and the links of the mesh give up what these then hold along the threads:
// half where the cloth shears as hard as it stretches, and less where it is soft askew to the threads, as most of a level's links lie.
// Along a thread the cloth holds Y + Y45 / 2: its own family, and the diagonals, whose modulus is Y45, a quarter each.
//
// At rest links are longer than the way by rounding, and more: what is at rest must stay there.
//
// A node weighs what the particles weigh that it carries, by their shares, and is where their centre of mass is (centres.cpp): then steps of
// nodes change the cloth's momentum and angular momentum by what the links gave, and they give none.
#include "engine/effects/level/level.h"

#include <algorithm>
#include <cmath>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"
#include "engine/effects/tear/tear.h"
#include "engine/effects/level/centres.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::level_nodes,  &buffers::level_gathers, &buffers::level_node_shares, &buffers::level_ends,
                                      &buffers::level_links,  &buffers::level_shares,  &buffers::level_centres,     &buffers::level_middles,
                                      &buffers::level_carried, &buffers::level_steps,  &buffers::level_lambda};

// Of the cloth's stiffness, what all levels have together.
constexpr double kPart = 0.25;

// Points that a further level is worth.
constexpr std::size_t kFewest = 12;

struct Level {
  cooking::Coarse coarse;
  std::vector<double> areas;          // m^2, of each node
  cooking::Weighed weighed;
  std::vector<float> factors;         // of the stiffness, of each node; empty: 1
};

struct ClothLevels {
  std::vector<std::uint32_t> particle_of;   // of each point
  std::vector<Level> levels;          // finest first
  cooking::Stiffness stiffness;
};

// Until they are laid out.
struct AllLevels {
  std::vector<ClothLevels> cloths;
};

// Of each point; not finite at seams, where it has several.
std::vector<Vec2> point_uvs(const Mesh& mesh) {
  std::vector<Vec2> uvs(mesh.points.size(), {-INFINITY, 0});
  if (mesh.render.triangles.size() != mesh.triangles.size()) return {};
  for (std::size_t v = 0; v < mesh.point_of.size(); ++v) {
    const Vec2 uv = mesh.render.uvs[v];
    Vec2& known = uvs[mesh.point_of[v]];
    const bool first = known.x == -INFINITY;
    if (first) known = uv;
    else if (known.x != uv.x || known.y != uv.y) known = {NAN, NAN};
  }
  return uvs;
}

// The links of a level by their nodes.
struct Ends {
  std::vector<std::vector<gpu::uvec4>> of_node;
};

// Relative, of a link's length.
constexpr double kSlack = 1e-5;
// m, of a link: no cloth is as large.
constexpr double kNeverTaut = 1e9;

double inverse_modulus(const cooking::Stiffness& stiffness, double along) {
  const double askew = along * (1 - along);
  return (1 - 2 * askew) / stiffness.stretch + (askew < 1e-9 ? 0 : 2 * askew / stiffness.shear);
}

// Of each link (N/m), and what they all hold of an even strain along a thread, as a part of what the cloth holds: the same along warp and
// weft.
struct Stiff {
  std::vector<double> of_link;
  double part = 0;
};

Stiff stiff(const Level& level, const cooking::Stiffness& stiffness) {
  Stiff made;
  std::vector<std::uint32_t> count(level.coarse.points.size());
  for (const auto& link : level.coarse.links) ++count[link.a], ++count[link.b];
  Eigen::Vector2d along_threads(0, 0);
  double area = 0;
  for (const auto& [a, b, rest, along] : level.coarse.links) {
    const double covered = level.areas[a] / count[a] + level.areas[b] / count[b], pull = 4 * covered / inverse_modulus(stiffness, along);
    made.of_link.push_back(pull / (rest * rest));
    along_threads += pull * Eigen::Vector2d(along * along, (1 - along) * (1 - along));
    area += covered;
  }
  const double whole = area * (stiffness.stretch + 0.5 / inverse_modulus(stiffness, 0.5));
  if (!std::isfinite(whole)) return made;   // rigid: no part is less
  made.part = std::min(1.0, along_threads.minCoeff() / whole);
  // Links hold most along the thread that they are nearer to.
  for (std::size_t l = 0; l < made.of_link.size(); ++l)
    made.of_link[l] *= made.part * whole / std::max(along_threads[level.coarse.links[l].along < 0.5], made.part * whole);
  return made;
}

Ends links_of(const Level& level, const cooking::Stiffness& stiffness, std::size_t levels, std::uint32_t first) {
  Ends ends{std::vector<std::vector<gpu::uvec4>>(level.coarse.points.size())};
  const std::vector<double> k = stiff(level, stiffness).of_link;
  const double part = kPart / static_cast<double>(levels);
  for (std::size_t l = 0; l < k.size(); ++l) {
    const auto& [a, b, rest, along] = level.coarse.links[l];
    // What weighs nothing goes nowhere, and would pull its neighbours there: a free cloth must not pull itself along. Lists are as long
    // whoever is held, so its links stay and are never taut.
    const bool is_slack = level.weighed.weightless[a] || level.weighed.weightless[b];
    const double length = is_slack ? kNeverTaut : rest * (1 + kSlack);
    // No area, no cloth.
    const double stiff = part * k[l] * cooking::in_series(level.factors, a, b);
    const double compliance = stiff > 0 ? std::min(1 / stiff, cooking::kSoftest) : cooking::kSoftest;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)})
      ends.of_node[from].push_back(
          gpu::pack_level_link({first + to, static_cast<float>(length), static_cast<float>(compliance)}));
  }
  return ends;
}

// A share as the GPU has it.
gpu::uvec4 packed(const cooking::Share& share, std::uint32_t first) {
  return gpu::pack_level_share({first + share.node[0], first + share.node[1], first + share.node[2]}, share.part[1], share.part[2]);
}

std::vector<cooking::Share> as_packed(const std::vector<cooking::Share>& shares) {
  std::vector<cooking::Share> used;
  for (const cooking::Share& share : shares) {
    const gpu::LevelShare unpacked = gpu::unpack_level_share(packed(share, 0));
    used.push_back({share.node, {unpacked.part0, unpacked.part1, unpacked.part2}, share.place});
  }
  return used;
}

// kg, of each point; 0: it is held.
std::vector<double> masses_of(const CookedFabric& fabric, std::span<const std::uint32_t> particle_of) {
  std::vector<double> masses;
  for (const std::uint32_t particle : particle_of) {
    const float w = fabric.positions[particle].w;
    masses.push_back(w > 0 ? 1 / double(w) : 0);
  }
  return masses;
}

// The mean of each node over the points that it carries, by their areas.
std::vector<float> at_nodes_of(const Level& level, const std::vector<float>& factors, const std::vector<double>& areas) {
  if (factors.empty()) return {};
  std::vector<double> sums(level.areas.size());
  for (std::size_t p = 0; p < areas.size(); ++p)
    for (int k = 0; k < 3; ++k)
      sums[level.coarse.shares[p].node[k]] += level.coarse.shares[p].part[k] * areas[p] * double(factors[p]);
  std::vector<float> means;
  for (std::size_t n = 0; n < sums.size(); ++n) means.push_back(level.areas[n] > 0 ? static_cast<float>(sums[n] / level.areas[n]) : 1.0f);
  return means;
}

// Along threads rigid cloth strains less. Cotton is farther off the reference then, and what holds cloth back gives way the less to that
// (engine/README.md, "Nodes along threads").
cooking::Nodes where_nodes_lie(const Scene& scene, const Fabric& fabric) {
  const bool is_rigid = std::isinf(fabric.stretch) && std::isinf(fabric.shear);
  const bool meets_something = !scene.colliders.empty() || contacts_on(scene);
  return is_rigid && !meets_something && scene.solver.order == 1 ? cooking::Nodes::along_threads : cooking::Nodes::anywhere;
}

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  state.has_levels = false;
  if (!levels_of(state.scene())) return {};
  auto& all = state.fabric().own.of<AllLevels>().cloths;
  all.resize(state.fabric().cloths.size());
  ClothLevels& cloth = all.back();
  cloth.particle_of.assign(state.particle_of().begin(), state.particle_of().end());
  cloth.stiffness = {input.cloth.fabric.stretch, input.cloth.fabric.shear};
  cooking::IntrinsicSurface surface = cooking::surface_of(input.mesh);
  std::vector<cooking::Rank> ranks = cooking::ranks_of(input.mesh);
  for (const auto& anchor : input.anchors) ranks[anchor.point] = cooking::Rank::held;
  std::vector<Vec2> uvs = point_uvs(input.mesh);
  std::vector<double> areas(ranks.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& c = surface.flat[t].corners;
    for (const std::uint32_t p : surface.triangles[t]) areas[p] += 0.5 * c[1].x() * c[2].y() / 3;
  }
  cooking::Weights weights{masses_of(state.fabric(), cloth.particle_of)};
  std::vector<cooking::Mean> in_points;
  std::vector<float> factors = input.factors.stretch;
  while (ranks.size() > kFewest) {
    Level level{cooking::coarsen(surface, ranks, uvs, where_nodes_lie(state.scene(), input.cloth.fabric)), {}, {}, {}};
    const std::vector<std::uint32_t>& points = level.coarse.points;
    if (2 * points.size() > ranks.size() || points.size() < 3) break;   // small pieces
    level.areas.resize(points.size());
    for (std::size_t p = 0; p < areas.size(); ++p)
      for (int k = 0; k < 3; ++k) level.areas[level.coarse.shares[p].node[k]] += level.coarse.shares[p].part[k] * areas[p];
    factors = level.factors = at_nodes_of(level, factors, areas);
    const auto at_nodes = [&](auto& of_points) {
      std::remove_reference_t<decltype(of_points)> of_nodes;
      for (const std::uint32_t p : points) of_nodes.push_back(of_points[p]);
      of_points = std::move(of_nodes);
    };
    at_nodes(ranks);
    if (!uvs.empty()) at_nodes(uvs);
    level.weighed = cooking::weigh(level.coarse, as_packed(level.coarse.shares), weights, in_points, state.may_pin());
    cooking::measure_between_middles(level.coarse, level.weighed.in_nodes);
    weights = {level.weighed.masses, level.weighed.weightless};
    in_points = level.weighed.in_nodes;
    areas = level.areas;
    surface = level.coarse.surface;
    cloth.levels.push_back(std::move(level));
  }
  if (state.scene().solver.method == Method::implicit) return {};   // these carry no stiffness there
  state.has_levels = !cloth.levels.empty();
  state.own_part = 1;
  for (const Level& level : cloth.levels) state.own_part -= kPart * stiff(level, cloth.stiffness).part / static_cast<double>(cloth.levels.size());
  return {};
}

class Layout {
 public:
  Layout(CookedFabric& fabric, const std::vector<ClothLevels>& cloths, bool may_tear)
      : fabric_(fabric), cloths_(cloths), may_tear_(may_tear), lists_(fabric.own.of<LevelLists>()), first_(cloths.size()) {}

  void lay_out() {
    std::size_t deepest = 0;
    for (const ClothLevels& cloth : cloths_) deepest = std::max(deepest, cloth.levels.size());
    if (deepest == 0) return keep_passes();
    number(deepest);
    for (std::size_t g = deepest; g-- > 0;)
      for (std::size_t c = 0; c < cloths_.size(); ++c)
        if (g < cloths_[c].levels.size()) add_level(c, g);
    lists_.nodes.push_back(gpu::pack_level_node({static_cast<std::uint32_t>(lists_.gathers.size()), 0, 0, 0}));
    for (std::uint32_t k = 0, first = 0; k < lists_.ends.size() && lists_.ends[k] - first <= WEFT_LOW_LEVEL; first = lists_.ends[k++])
      lists_.low = k + 1;
    if (may_tear_) lists_.low = static_cast<std::uint32_t>(lists_.ends.size());   // torn cloth may have more nodes, and the same passes
    add_shares();
  }

 private:
  // Cloth that has torn into small pieces has no levels any more, and the same passes: with one node that carries nothing.
  void keep_passes() {
    if (!may_tear_) return;
    lists_.ends = {1};
    lists_.low = 1;
    lists_.nodes.assign(2, gpu::pack_level_node({0, 0, 0, 0}));
    lists_.gathers.push_back(gpu::pack_level_gather({0, 0, 0}));
    lists_.node_shares.push_back({WEFT_NONE, 0, 0, 0});
    lists_.links.push_back({});
    add_shares();
  }

  bool is_held(std::size_t c, std::uint32_t point) const { return fabric_.positions[cloths_[c].particle_of[point]].w == 0; }

  // Coarsest first, cloth after cloth.
  void number(std::size_t deepest) {
    std::uint32_t nodes = 0;
    for (std::size_t g = deepest; g-- > 0;) {
      for (std::size_t c = 0; c < cloths_.size(); ++c) {
        first_[c].resize(cloths_[c].levels.size());
        if (g >= cloths_[c].levels.size()) continue;
        first_[c][g] = nodes;
        nodes += static_cast<std::uint32_t>(cloths_[c].levels[g].coarse.points.size());
      }
      lists_.ends.push_back(nodes);
    }
  }

  void add_level(std::size_t c, std::size_t g) {
    const Level& level = cloths_[c].levels[g];
    const bool has_coarser = g + 1 < cloths_[c].levels.size();
    const Ends ends = links_of(level, cloths_[c].stiffness, cloths_[c].levels.size(), first_[c][g]);
    for (std::uint32_t k = 0; k < level.coarse.points.size(); ++k) {
      const double mass = level.weighed.masses[k];
      lists_.nodes.push_back(gpu::pack_level_node({static_cast<std::uint32_t>(lists_.gathers.size()), mass > 0 ? static_cast<float>(1 / mass) : 0,
                                                   static_cast<std::uint32_t>(lists_.links.size()),
                                                   static_cast<std::uint32_t>(ends.of_node[k].size())}));
      for (const auto& [point, in_centre, in_middle] : level.weighed.gathers[k])
        lists_.gathers.push_back(gpu::pack_level_gather({g == 0 ? cloths_[c].particle_of[point] : first_[c][g - 1] + point,
                                                         static_cast<float>(in_centre), static_cast<float>(in_middle)}));
      lists_.node_shares.push_back(has_coarser ? packed(cloths_[c].levels[g + 1].coarse.shares[k], first_[c][g + 1])
                                               : gpu::uvec4{WEFT_NONE, 0, 0, 0});
      lists_.links.insert(lists_.links.end(), ends.of_node[k].begin(), ends.of_node[k].end());
    }
  }

  void add_shares() {
    lists_.shares.assign(fabric_.positions.size(), {WEFT_NONE, 0, 0, 0});
    for (std::size_t c = 0; c < cloths_.size(); ++c) {
      if (cloths_[c].levels.empty()) continue;
      for (std::uint32_t p = 0; p < cloths_[c].particle_of.size(); ++p)
        if (!is_held(c, p)) lists_.shares[cloths_[c].particle_of[p]] = packed(cloths_[c].levels[0].coarse.shares[p], first_[c][0]);
    }
  }

  CookedFabric& fabric_;
  const std::vector<ClothLevels>& cloths_;
  bool may_tear_;
  LevelLists& lists_;
  std::vector<std::vector<std::uint32_t>> first_;   // node, by cloth and level
};

void lay_out(cooking::CookState& state) {
  auto& all = state.fabric().own.of<AllLevels>();
  Layout(state.fabric(), all.cloths, levels_of(state.scene()) && tears(state.scene())).lay_out();
  if (!state.may_pin()) all = {};
}

// The levels as they were chosen, with other masses: what is held now is carried by no node, and a node at its place is held.
void hold(cooking::CookState& state, std::span<const Mesh>) {
  CookedFabric& fabric = state.fabric();
  auto& all = fabric.own.of<AllLevels>();
  for (ClothLevels& cloth : all.cloths) {
    cooking::Weights weights{masses_of(fabric, cloth.particle_of)};
    for (Level& level : cloth.levels) {
      level.weighed = cooking::weigh(level.coarse, as_packed(level.coarse.shares), weights, {}, true, cooking::Middles::unknown);
      weights = {level.weighed.masses, level.weighed.weightless};
    }
  }
  fabric.own.of<LevelLists>() = {};
  Layout(fabric, all.cloths, levels_of(state.scene()) && tears(state.scene())).lay_out();
}

// The method implicit has the levels' nodes as a preconditioner (engine/effects/implicit/levels.cpp), and no links between them.
bool by_links(const Needs& needs) { return !needs.has(EffectId::implicit); }
bool wide_by_links(const Needs& needs) { return by_links(needs) && levels::has_wide(needs); }

constexpr Pass kPasses[] = {
    {.name = "level_centre", .stage = Stage::iteration, .threads = {levels::nodes}, .when = by_links, .ranges = levels::finest},
    {.name = "level_centre_wide",
     .stage = Stage::iteration,
     .threads = {levels::nodes},
     .when = wide_by_links,
     .ranges = levels::wide_but_finest},
    {.name = "level_low", .stage = Stage::iteration, .threads = {levels::low, lengths::one}, .when = by_links, .alone = true},
    {.name = "level_wide", .stage = Stage::iteration, .threads = {levels::nodes}, .when = wide_by_links, .ranges = levels::wide},
    {.name = "level_spread",
     .stage = Stage::iteration,
     .threads = threads::particles,
     .when = [](const Needs& needs) { return by_links(needs) && !needs.has(EffectId::strand); }},   // its first round does that
};

constexpr Figure kFigures[] = {
    {.name = "levels.count", .cooked = [](const CookedFabric& f) { return std::uint64_t(f.own.of<LevelLists>().ends.size()); }},
    {.name = "levels.nodes", .cooked = [](const CookedFabric& f) {
       const LevelLists& lists = f.own.of<LevelLists>();
       return std::uint64_t(lists.ends.empty() ? 0 : lists.ends.back());
     }}};

}  // namespace
}  // namespace weft::effects

namespace weft::levels {
namespace {

Range nodes_of(const LevelLists& lists, std::size_t level) {
  const std::uint32_t first = level == 0 ? 0 : lists.ends[level - 1];
  return {first, lists.ends[level] - first};
}

}  // namespace

std::uint64_t nodes(const Cooked& s) { return s.fabric.own.of<LevelLists>().nodes.size(); }
std::uint64_t low(const Cooked& s) { return s.fabric.own.of<LevelLists>().low; }
bool has_wide(const Needs& needs) { return needs.constants[gpu::constant::has_wide_levels] != 0; }

std::vector<Range> finest(const Cooked& s) {
  const LevelLists& lists = s.fabric.own.of<LevelLists>();
  if (lists.ends.empty()) return {};
  return {nodes_of(lists, lists.ends.size() - 1)};
}

std::vector<Range> wide(const Cooked& s) {
  const LevelLists& lists = s.fabric.own.of<LevelLists>();
  std::vector<Range> ranges;
  for (std::size_t k = lists.low; k < lists.ends.size(); ++k) ranges.push_back(nodes_of(lists, k));
  return ranges;
}

std::vector<Range> wide_but_finest(const Cooked& s) {
  std::vector<Range> ranges = wide(s);
  if (!ranges.empty()) ranges.pop_back();
  std::reverse(ranges.begin(), ranges.end());
  return ranges;
}

}  // namespace weft::levels

namespace weft::effects {

constinit const Effect level{
    .name = "level",
    .key = "solver.levels",
    .called_for = [](const Scene&, const CookedFabric& fabric) { return !fabric.own.of<LevelLists>().nodes.empty(); },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize =
        [](const Cooked& s, Constants& constants) {
          const LevelLists& lists = s.fabric.own.of<LevelLists>();
          constants[gpu::constant::has_levels] = 1;
          constants[gpu::constant::has_wide_levels] = lists.low < lists.ends.size();
        },
    .reference = Reference::a_way_to,
    .figures = kFigures,
    .cook = cook,
    .lay_out = lay_out,
    .hold = hold,
};

}  // namespace weft::effects
