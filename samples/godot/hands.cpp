// See samples/godot/hands.h.
#include "samples/godot/hands.h"

#include <algorithm>

namespace weft_godot {
namespace {

using weft::fail;
using weft::Result;
using weft::Simulation;

// Numbers of a cloth's vertices as the whole simulation's. Errors: a vertex that the cloth does not have.
Result<std::vector<std::uint32_t>> in_simulation(const Simulation& simulation, const Hand& hand) {
  const weft::ClothRange& range = simulation.fabric().cloths[hand.cloth];
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t v : hand.vertices) {
    if (v >= range.vertices) return fail("there is no vertex ", v, ", the cloth has ", range.vertices);
    vertices.push_back(range.first_vertex + v);
  }
  return vertices;
}

// A render vertex of a point, the first.
std::uint32_t vertex_of(const Simulation& simulation, std::uint32_t cloth, std::uint32_t point) {
  const std::vector<std::uint32_t>& point_of = simulation.meshes()[cloth].point_of;
  const auto first = std::ranges::find(point_of, point);
  return simulation.fabric().cloths[cloth].first_vertex + static_cast<std::uint32_t>(first - point_of.begin());
}

}  // namespace

Result<void> Hands::act(Simulation& simulation, const Hand& hand) {
  if (hand.what == Hand::Does::move_grab || hand.what == Hand::Does::let_go) {
    const auto held = grabs_.find(hand.grab);
    if (held == grabs_.end()) return fail("no grab has the number ", hand.grab);
    if (hand.what == Hand::Does::move_grab) {
      if (hand.targets.size() != 1) return fail("a grab has one target");
      held->second.target = hand.targets[0];
      return simulation.move_grab(held->second.number, hand.targets[0]);
    }
    const std::uint32_t number = held->second.number;
    grabs_.erase(held);
    return simulation.let_go(number);
  }
  const auto vertices = in_simulation(simulation, hand);
  if (!vertices) return vertices.why();
  Result<void> done = hand.what == Hand::Does::pin       ? simulation.pin(*vertices)
                      : hand.what == Hand::Does::release ? simulation.release(*vertices)
                                                         : simulation.move_pins(*vertices, hand.targets);
  if (!done) return done;
  for (const std::uint32_t v : hand.vertices) {
    const std::pair at(hand.cloth, simulation.meshes()[hand.cloth].point_of[v]);
    if (hand.what == Hand::Does::pin) {
      pinned_.insert(at);
      if (released_.erase(at) > 0) moved_.insert(at);   // an anchor, maybe, which is the hand's now
    }
    if (hand.what == Hand::Does::release) released_.insert(at), pinned_.erase(at), moved_.erase(at);
    if (hand.what == Hand::Does::move_pins) moved_.insert(at);
  }
  return {};
}

Result<std::optional<Hands::Held>> Hands::grab(Simulation& simulation, weft::Vec3 origin, weft::Vec3 direction, const weft::Grip& grip) {
  const auto grabbed = simulation.grab(origin, direction, grip);
  if (!grabbed) return grabbed.why();
  if (!*grabbed) return std::optional<Held>();
  grabs_[++last_] = {(*grabbed)->grab, (*grabbed)->cloth, grip, (*grabbed)->point};
  return std::optional(Held{last_, **grabbed});
}

bool Hands::have(const Simulation& simulation, const weft::AnchorTarget& anchor) const {
  if (released_.empty() && moved_.empty()) return false;
  const std::pair at(anchor.cloth, simulation.meshes()[anchor.cloth].point_of[anchor.vertex]);
  return released_.contains(at) || moved_.contains(at);
}

Result<void> Hands::carry(const Hands& from, Simulation& to, std::span<const std::optional<std::uint32_t>> carried) {
  std::map<std::uint32_t, std::uint32_t> next;   // a cloth's place there by that in the last
  for (std::uint32_t c = 0; c < carried.size(); ++c)
    if (carried[c]) next[*carried[c]] = c;
  const auto take_over = [&](const Points& points, Points& taken) {
    std::vector<std::uint32_t> vertices;
    for (const auto& [cloth, point] : points)
      if (const auto at = next.find(cloth); at != next.end() && point < to.meshes()[at->second].points.size()) {
        taken.emplace(at->second, point);
        vertices.push_back(vertex_of(to, at->second, point));
      }
    return vertices;
  };
  const std::vector<std::uint32_t> released = take_over(from.released_, released_), pinned = take_over(from.pinned_, pinned_);
  take_over(from.moved_, moved_);
  if (!released.empty())
    if (auto done = to.release(released); !done) return done;
  if (!pinned.empty())
    if (auto done = to.pin(pinned); !done) return done;
  last_ = from.last_;
  for (const auto& [number, grab] : from.grabs_) {
    if (!next.contains(grab.cloth)) continue;
    const auto again = to.grab_near(grab.target, grab.grip);
    if (!again) return again.why();
    grabs_[number] = {again->grab, again->cloth, grab.grip, grab.target};
    if (auto done = to.move_grab(again->grab, grab.target); !done) return done;
  }
  return {};
}

}  // namespace weft_godot
