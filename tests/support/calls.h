// What the tests of plans share: every combination of effects that a scene can call for, and the plan of each.
#pragma once

#include <gtest/gtest.h>

#include <compare>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "engine/solve/plan.h"

namespace weft {

using Id = EffectId;
namespace constant = gpu::constant;
inline constexpr std::uint32_t kWorkgroup = 128, kNarrow = 64, kAlone = 256, kCrew = 512, kThin = 4;

// What a scene calls for, in short.
struct Calls {
  std::set<Id> effects;        // besides motion and surface
  bool iterated = false;       // several iterations a substep
  bool relaxed = false;        // the method implicit, solved by Jacobi
  auto operator<=>(const Calls&) const = default;
  bool has(Id id) const { return effects.contains(id); }
};

inline Needs setup_for(const Calls& calls, bool texels) {
  Needs setup;
  setup.narrow = kNarrow;
  setup.alone = kAlone;
  setup.crew = kCrew;
  setup.thin = kThin;
  setup.constants[constant::workgroup] = kWorkgroup;
  setup.constants[constant::through_texels] = texels;
  setup.constants[constant::idle_costs] = calls.has(Id::tether);   // by turns
  setup.constants[constant::is_iterated] = calls.iterated;
  setup.constants[constant::linear_solver] = calls.relaxed ? WEFT_LINEAR_JACOBI : WEFT_LINEAR_CG;
  setup.constants[constant::is_accelerated] = calls.has(Id::chebyshev);
  setup.constants[constant::has_levels] = setup.constants[constant::has_wide_levels] = calls.has(Id::level);
  setup.constants[constant::tether_pairs] = calls.has(Id::tether);
  setup.constants[constant::has_colliders] = setup.constants[constant::spheres] = calls.has(Id::collide);
  for (const auto bodies : {constant::capsules, constant::has_tapered, constant::has_body_masks, constant::resizes})
    setup.constants[bodies] = calls.has(Id::collide) && calls.iterated;
  setup.constants[constant::contact_mask_words] = calls.has(Id::contact) && calls.iterated;
  setup.constants[constant::triangles_collide] = setup.constants[constant::boxes] = calls.has(Id::triangle);
  setup.constants[constant::has_contacts] = calls.has(Id::contact);
  setup.constants[constant::untangles] = calls.has(Id::untangle);
  setup.constants[constant::air_wave_count] = setup.constants[constant::air_field_count] = calls.has(Id::air);
  setup.constants[constant::has_maps] = calls.has(Id::render_mesh);
  setup.constants[constant::air_every] = calls.has(Id::air) ? 2 : 0;
  setup.constants[constant::has_lee] = setup.constants[constant::wake_count] = calls.has(Id::air) && calls.has(Id::collide);
  setup.constants[constant::motion_constraints] = calls.has(Id::motion_constraint) ? 2 : 0;
  setup.constants[constant::skins_move_anchors] = calls.has(Id::skin) && calls.has(Id::anchor);
  if (calls.has(Id::skin) && calls.has(Id::contact)) setup.constants[constant::morphs] = calls.has(Id::motion_constraint) ? 2 : 1;
  setup.constants[constant::takes_targets] = setup.constants[constant::morphs] > 0;
  setup.constants[constant::has_supports] = calls.has(Id::support);
  setup.constants[constant::is_second_order] = calls.has(Id::bdf2);
  setup.constants[constant::grab_count] = calls.has(Id::grab);
  setup.constants[constant::reacts] = calls.has(Id::reaction);
  setup.constants[constant::first_mesh_body] = calls.has(Id::reaction) && calls.has(Id::contact);
  for (const Id id : {Id::motion, Id::surface}) setup.effects.set(static_cast<std::size_t>(id));
  for (const Id id : calls.effects) setup.effects.set(static_cast<std::size_t>(id));
  return setup;
}

inline std::string words(const Calls& calls) {
  std::string text = std::string(calls.iterated ? "iterated " : "") + (calls.relaxed ? "relaxed " : "");
  for (const Id id : calls.effects) text += std::string(effect(id).name) + ' ';
  return text;
}

inline Calls with(Calls calls, std::initializer_list<Id> more) {
  calls.effects.insert(more.begin(), more.end());
  return calls;
}

// Every combination that a scene can call for (engine/scene/method.cpp).
inline std::vector<Calls> combinations() {
  std::vector<Calls> found;
  constexpr Id kAny[] = {Id::anchor, Id::bend, Id::tether, Id::collide, Id::contact, Id::triangle};
  for (std::uint32_t bits = 0; bits < 128; ++bits) {
    Calls calls;
    for (std::size_t k = 0; k < std::size(kAny); ++k)
      if (bits >> k & 1) calls.effects.insert(kAny[k]);
    calls.iterated = bits >> 6 & 1;
    if (calls.has(Id::triangle) && !calls.has(Id::collide)) continue;
    found.push_back(with(calls, {Id::stretch}));
    if (calls.has(Id::contact) && calls.has(Id::anchor)) found.push_back(with(calls, {Id::stretch, Id::untangle}));
    // What changes the passes of others makes each of these modules anew: with one in eight.
    if (!calls.iterated && calls.has(Id::bend) == calls.has(Id::tether) && calls.has(Id::anchor) == calls.has(Id::collide)) {
      if (calls.has(Id::anchor)) found.push_back(with(calls, {Id::stretch, Id::skin}));
      found.push_back(with(calls, {Id::stretch, Id::skin, Id::motion_constraint}));
      found.push_back(with(calls, {Id::gauss_seidel, Id::skin, Id::motion_constraint}));
      if (calls.has(Id::collide)) found.push_back(with(calls, {Id::stretch, Id::reaction}));
      if (calls.has(Id::collide)) found.push_back(with(calls, {Id::stretch, Id::strand, Id::level, Id::reaction}));
    }
    found.push_back(with(calls, {Id::gauss_seidel}));
    found.push_back(with(calls, {Id::gauss_seidel, Id::level}));
    if (!calls.iterated) found.push_back(with(calls, {Id::gauss_seidel, Id::level, Id::shift}));
    found.push_back(with(calls, {Id::stretch, Id::level}));
    if (!calls.has(Id::contact) && !(calls.iterated && calls.has(Id::collide))) {
      if (calls.has(Id::tether)) found.push_back(with(calls, {Id::stretch, Id::bdf2}));
      else found.push_back(with(calls, {Id::stretch, Id::level, Id::bdf2}));
    }
    found.push_back(with(calls, {Id::stretch, Id::strand}));
    found.push_back(with(calls, {Id::stretch, Id::strand, Id::level}));
    if (!calls.iterated) found.push_back(with(calls, {Id::stretch, Id::strand, Id::level, Id::shift}));
    found.push_back(with(calls, {Id::stretch, Id::dihedral}));
    found.push_back(with(calls, {Id::gauss_seidel, Id::dihedral}));
    if (calls.iterated && !calls.has(Id::contact) && !calls.has(Id::tether)) found.push_back(with(calls, {Id::stretch, Id::chebyshev}));
    if (calls.iterated || calls.has(Id::bend)) continue;   // links and bends: not of the methods on springs
    found.push_back(with(calls, {Id::spring}));
    found.push_back(with(calls, {Id::spring, Id::implicit}));
    found.push_back(with(calls, {Id::spring, Id::implicit, Id::level}));
    found.push_back(with(calls, {Id::spring, Id::implicit}));
    found.back().relaxed = true;
  }
  // Fine cloth, which colliders hold: with one in eight.
  for (std::size_t k = 0, coarse = found.size(); k < coarse; ++k) {
    const Calls calls = found[k];
    if (!calls.has(Id::collide) || calls.has(Id::spring) || calls.has(Id::chebyshev)) continue;
    if (calls.has(Id::anchor) && calls.has(Id::bend) == calls.has(Id::tether) && calls.iterated == calls.has(Id::contact))
      found.push_back(with(calls, {Id::support}));
  }
  return found;
}

// Effects that these do not know: forces, and whatever else goes with everything and is no constant of others' passes.
inline std::vector<Id> others() {
  constexpr Id kKnown[] = {Id::anchor,   Id::level,     Id::strand, Id::stretch, Id::gauss_seidel, Id::bend,   Id::dihedral, Id::spring,
                           Id::implicit, Id::chebyshev, Id::tether, Id::collide, Id::triangle,     Id::motion, Id::contact,  Id::surface,
                           Id::untangle, Id::skin,      Id::motion_constraint, Id::reaction, Id::support, Id::bdf2,  Id::shift};
  std::vector<Id> found;
  for (std::size_t k = 0; k < kEffects; ++k)
    if (std::find(std::begin(kKnown), std::end(kKnown), Id(k)) == std::end(kKnown)) found.push_back(Id(k));
  return found;
}

// Under the sanitizers, where each takes six times as long: every third, and those of the rest that have two effects together which none
// of these has, so that no pass is left out. What sanitizers look for lies in what all combinations share.
inline std::vector<Calls> fewer(const std::vector<Calls>& combinations) {
  std::set<std::pair<Id, Id>> pairs;
  const auto adds_pairs = [&pairs](const Calls& calls) {
    const std::size_t before = pairs.size();
    for (const Id a : calls.effects)
      for (const Id b : calls.effects) pairs.emplace(a, b);
    return pairs.size() > before;
  };
  std::vector<Calls> found;
  for (std::size_t k = 0; k < combinations.size(); k += 3) adds_pairs(found.emplace_back(combinations[k]));
  for (const Calls& calls : combinations)
    if (adds_pairs(calls)) found.push_back(calls);
  return found;
}

// Every combination without and with all of these.
inline std::vector<Calls> all_combinations() {
  std::vector<Calls> found = combinations();
#ifdef WEFT_SANITIZED
  found = fewer(found);
#endif
  const std::vector<Id> more = others();
  const std::size_t known = more.empty() ? 0 : found.size();
  for (std::size_t k = 0; k < known; ++k) {
    found.push_back(found[k]);
    found.back().effects.insert(more.begin(), more.end());
  }
  return found;
}

inline compute::Specializer& specializer() {
  static compute::Specializer shared;   // what one plan has specialised another need not
  return shared;
}

// Made once for all tests of a process.
inline const Plan& plan_for(const Calls& calls, bool texels = true) {
  static std::map<std::pair<Calls, bool>, Plan> made;
  if (const auto before = made.find({calls, texels}); before != made.end()) return before->second;
  auto plan = make_plan(setup_for(calls, texels), specializer());
  EXPECT_TRUE(plan) << words(calls) << ": " << plan.error();
  return made.try_emplace({calls, texels}, plan ? std::move(*plan) : Plan{}).first->second;
}

template <class Body>
void for_every_plan(Body body) {
  for (const Calls& calls : all_combinations())
    for (const bool texels : {true, false}) {
      SCOPED_TRACE(words(calls) + (texels ? "texels" : "storage"));
      body(plan_for(calls, texels), calls, texels);
    }
}

}  // namespace weft
