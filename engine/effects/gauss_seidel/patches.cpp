// Patches for Gauss-Seidel: particles that lie together, with the links among them, so that one workgroup solves these in its own
// memory (gauss_seidel.comp). Patches of a round share no particle. A round is a dispatch, so rounds should be few.
//
//     . . . | . . .     The first round cuts the particles into compact boxes, by bisection of their coordinates, and solves the
//     . A . | . B .     links inside them. What is left crosses the boxes' sides: a network of narrow strips. In the second round
//     . . . | . . .     patches grow along these, as far as they hold, and in the third over the few places where those ended.
//     ------+------     Grids need three rounds, and so does nearly every other mesh; more are made where that leaves links.
//     . C . | . D .
//
// Inside a patch links have colours, no two of one colour with a particle in common: greedy, each link in turn takes the lowest
// colour that neither of its ends has yet. All of a colour are solved at once.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "engine/effects/gauss_seidel/gauss_seidel.h"

namespace weft::cooking {
namespace {

constexpr std::uint32_t kMost = WEFT_PATCH;

using Group = std::vector<std::uint32_t>;   // particles, or numbers of links

// Cuts particles[first, last) into boxes of at most kMost, along cloths first.
class Boxes {
 public:
  Boxes(const CookedFabric& fabric, Group particles) : fabric_(fabric), particles_(std::move(particles)) {
    cut(0, particles_.size());
  }
  std::vector<Group> groups;

 private:
  void cut(std::size_t first, std::size_t last) {
    const std::size_t count = last - first;
    if (count <= kMost) {
      if (count > 0) groups.emplace_back(particles_.begin() + at(first), particles_.begin() + at(last));
      return;
    }
    // As many full patches on either side as make the sizes even.
    const std::size_t parts = (count + kMost - 1) / kMost, middle = first + count * (parts / 2) / parts;
    const int axis = longest(first, last);
    std::nth_element(particles_.begin() + at(first), particles_.begin() + at(middle), particles_.begin() + at(last),
                     [&](std::uint32_t a, std::uint32_t b) { return std::pair(along(a, axis), a) < std::pair(along(b, axis), b); });
    cut(first, middle);
    cut(middle, last);
  }

  static std::ptrdiff_t at(std::size_t k) { return static_cast<std::ptrdiff_t>(k); }

  // Axis 3 counts cloths.
  float along(std::uint32_t i, int axis) const {
    const gpu::vec4& x = fabric_.positions[i];
    return axis == 0 ? x.x : axis == 1 ? x.y : axis == 2 ? x.z : static_cast<float>(body_of(fabric_, i));
  }

  int longest(std::size_t first, std::size_t last) const {
    std::array<float, 4> low, high;
    low.fill(INFINITY), high.fill(-INFINITY);
    for (std::size_t k = first; k < last; ++k)
      for (int axis = 0; axis < 4; ++axis) {
        const float x = along(particles_[k], axis);
        low[axis] = std::min(low[axis], x), high[axis] = std::max(high[axis], x);
      }
    if (high[3] > low[3]) return 3;
    int widest = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (high[axis] - low[axis] > high[widest] - low[widest]) widest = axis;
    return widest;
  }

  const CookedFabric& fabric_;
  Group particles_;
};

class Patches {
 public:
  Patches(const CookedFabric& fabric, PatchLists& lists) : fabric_(fabric), lists_(lists), place_(fabric.positions.size()) {
    // Far links and second diagonals first: a sweep ends with the edges.
    for (const bool pulls : {true, false})
      for (std::uint32_t k = 0; k < fabric.links.size(); ++k) {
        const StretchLink& link = fabric.links[k];
        if (link.only_pulls == pulls && (may_move(link.a) || may_move(link.b))) left_.push_back(k);
      }
  }

  void make() {
    lists_.colour_ends.push_back(0);
    for (std::uint32_t round = 0; !left_.empty(); ++round) {
      find_links_left();
      add_round(round == 0 ? Boxes(fabric_, linked_).groups : grown());
    }
  }

 private:
  bool may_move(std::uint32_t particle) const { return fabric_.positions[particle].w > 0 || !fabric_.inverse_masses.empty(); }

  struct Place {
    std::uint32_t patch = kNone, member = 0;
  };
  // Of each particle, the links that are left.
  void find_links_left() {
    uses_.assign(fabric_.positions.size(), {});
    linked_.clear();
    for (const std::uint32_t k : left_) {
      const StretchLink& link = fabric_.links[k];
      uses_[link.a].push_back(link.b);
      uses_[link.b].push_back(link.a);
    }
    for (std::uint32_t i = 0; i < uses_.size(); ++i)
      if (!uses_[i].empty()) linked_.push_back(i);
  }

  // Breadth first along the links that are left, as far as a patch holds; what is joined to nothing more fills up the last one.
  std::vector<Group> grown() const {
    std::vector<Group> groups;
    std::vector<bool> taken(fabric_.positions.size());
    for (const std::uint32_t seed : linked_) {
      if (taken[seed]) continue;
      Group group{seed};
      taken[seed] = true;
      for (std::size_t k = 0; k < group.size(); ++k)
        for (const std::uint32_t other : uses_[group[k]])
          if (!taken[other] && group.size() < kMost) {
            taken[other] = true;
            group.push_back(other);
          }
      if (!groups.empty() && groups.back().size() + group.size() <= kMost)
        groups.back().insert(groups.back().end(), group.begin(), group.end());
      else
        groups.push_back(std::move(group));
    }
    return groups;
  }

  void add_round(const std::vector<Group>& groups) {
    std::fill(place_.begin(), place_.end(), Place{});
    for (std::uint32_t g = 0; g < groups.size(); ++g)
      for (std::uint32_t m = 0; m < groups[g].size(); ++m) place_[groups[g][m]] = {g, m};
    std::vector<Group> inside(groups.size());
    std::erase_if(left_, [&](std::uint32_t k) {
      const StretchLink& link = fabric_.links[k];
      const std::uint32_t patch = place_[link.a].patch;
      if (patch != place_[link.b].patch) return false;
      inside[patch].push_back(k);
      return true;
    });
    const auto first = static_cast<std::uint32_t>(lists_.patches.size());
    for (std::uint32_t g = 0; g < groups.size(); ++g)
      if (!inside[g].empty()) add_patch(groups[g], inside[g]);
    lists_.rounds.push_back({first, static_cast<std::uint32_t>(lists_.patches.size()) - first});
  }

  void add_patch(const Group& members, const Group& links) {
    gpu::Patch patch{static_cast<std::uint32_t>(lists_.members.size()), static_cast<std::uint32_t>(members.size()),
                     static_cast<std::uint32_t>(lists_.colour_ends.size()) - 1, 0};
    lists_.members.insert(lists_.members.end(), members.begin(), members.end());
    std::vector<std::vector<bool>> palettes(members.size());
    std::vector<std::vector<gpu::uvec2>> colours;
    for (const std::uint32_t k : links) {
      const StretchLink& link = fabric_.links[k];
      const std::uint32_t a = place_[link.a].member, b = place_[link.b].member;
      const auto has = [](const std::vector<bool>& palette, std::size_t colour) { return colour < palette.size() && palette[colour]; };
      std::size_t lowest = 0;
      while (has(palettes[a], lowest) || has(palettes[b], lowest)) ++lowest;
      for (std::vector<bool>* palette : {&palettes[a], &palettes[b]}) {
        if (palette->size() <= lowest) palette->resize(lowest + 1);
        (*palette)[lowest] = true;
      }
      if (colours.size() <= lowest) colours.resize(lowest + 1);
      colours[lowest].push_back(gpu::pack_patch_link({a, b, link.rest, link.own_compliance(), link.only_pulls}));
    }
    for (const auto& of_colour : colours) {
      lists_.links.insert(lists_.links.end(), of_colour.begin(), of_colour.end());
      lists_.colour_ends.push_back(static_cast<std::uint32_t>(lists_.links.size()));
    }
    patch.colours = static_cast<std::uint32_t>(colours.size());
    lists_.patches.push_back(patch);
  }

  const CookedFabric& fabric_;
  PatchLists& lists_;
  Group left_, linked_;                       // links; the particles that these join
  std::vector<Group> uses_;                   // of each particle: whom they join it to
  std::vector<Place> place_;
};

}  // namespace

void make_patches(CookedFabric& fabric) { Patches(fabric, fabric.own.of<PatchLists>()).make(); }

}  // namespace weft::cooking
