// What the GPU tests of contacts share: tufts as a scene, and the contact passes on a state that detection could have left.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "engine/solve/frame_program.h"
#include "tests/support/single_pass.h"
#include "tests/support/tufts.h"

namespace weft {

using reference::Tufts;

inline constexpr float kFriction[] = {0.3f, 0.7f};   // of the particles by turns
inline constexpr std::uint32_t kNoneHeld = 1000000;

inline gpu::vec4 with(const reference::Vector& v, float w) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), w};
}

inline CookedFabric fabric_of(const Tufts& t, const SolverSettings& solver) {
  Random random(0);
  CookedFabric fabric = loose_particles(random, static_cast<std::uint32_t>(t.x.size()), solver);
  for (std::size_t i = 0; i < t.x.size(); ++i) {
    const auto w = static_cast<float>(t.inverse_masses[i]);
    fabric.positions[i] = with(t.x[i], w);
    fabric.split_weights[i] = fabric.iterate_weights[i] = w;
    fabric.rest.push_back(with(t.x[i], 0.005f));
  }
  for (std::size_t k = 0; k < 2; ++k) fabric.materials[k].friction = kFriction[k];
  fabric.triangles = {{0, 1, 2}};
  fabric.cloth_triangles = 1;
  fabric.edges = {{0, 1}};
  fabric.mean_edge = reference::kTuftSize;
  return fabric;
}

inline Scene scene_of(const Tufts& t) {
  Scene scene = loose_scene(1);
  scene.contacts.enabled = true;
  scene.contacts.detection_margin = 0.005;   // m
  scene.contacts.capacity = static_cast<std::uint32_t>(t.pairs.size());
  return scene;
}

// The passes on a state that detection could have left: every pair a candidate, on displacement bounds of 100 m.
class Passes : public SinglePass {
 public:
  Passes(const compute::Device& device, const Scene& scene, const CookedFabric& fabric, const Tufts& t, bool gather_storage,
         std::optional<bool> idle_costs = {})
      : SinglePass(device, scene, fabric, gather_storage, 0, idle_costs), t_(t) {
    std::vector<gpu::vec4> p;
    for (const reference::Vector& at : t.p) p.push_back(with(at, 0));
    put(buffers::velocities, leading_to(p, fabric));
    put_iterate(p);
    put(buffers::detected_positions, fabric.positions);
    put(buffers::displacement_bounds, std::vector<std::uint32_t>(t.x.size(), std::bit_cast<std::uint32_t>(100.0f) | WEFT_PAIRED));
    put_pairs(t.pairs);
    begin(frame_of(1));
    recover = static_cast<float>(scene.contacts.recover * fabric.h);
    quantum = contact_settings(scene, fabric).quantum;
  }
  void put_pairs(const std::vector<reference::Pair>& pairs) {
    std::vector<gpu::uvec4> candidates;
    for (const auto& [i, separation, edges] : pairs)
      candidates.push_back(gpu::pack_candidate(i[0], i[1], i[2], i[3], static_cast<float>(separation), edges));
    put(buffers::candidates, candidates);
    std::vector<gpu::Detection> detection(1);
    const auto groups = [](std::size_t threads) { return gpu::Groups{static_cast<std::uint32_t>(threads + 63) / 64, 1, 1}; };
    detection[0].contacts = groups(pairs.size());
    detection[0].paired = groups(t_.x.size());
    detection[0].alone = {1, 1, 1};
    detection[0].touched = {0, 1, 1};
    for (gpu::Groups& listed : detection[0].listed) listed = {0, 1, 1};
    detection[0].candidates = static_cast<std::uint32_t>(pairs.size());
    detection[0].lifetime = WEFT_LONGEST_LIFETIME;
    put(buffers::detection, detection);
  }
  /// What prepare has made of the pairs.
  std::vector<reference::Contact> contacts() const {
    const auto normals = get<gpu::vec4>(buffers::contact_normals, t_.pairs.size()),
               weights = get<gpu::vec4>(buffers::contact_weights, t_.pairs.size());
    std::vector<reference::Contact> contacts;
    for (std::size_t k = 0; k < t_.pairs.size(); ++k) {
      const gpu::vec4 &n = normals[k], &w = weights[k];
      contacts.push_back({vector(n).norm() > 0, n.w >= 0, vector(n), weights_of(w, t_.pairs[k].edges), n.w});
    }
    return contacts;
  }
  static reference::Weights weights_of(const gpu::vec4& stored, bool edges) {   // contact.glsl
    return {edges ? 1 - stored.y : 1, stored.y, stored.z, stored.w};
  }
  /// As contact_prepare does where each particle that can move has active contacts.
  void touch_all() {
    std::vector<std::uint32_t> touched;
    for (std::uint32_t i = 0; i < t_.x.size(); ++i)
      if (t_.inverse_masses[i] > 0) touched.push_back(i);
    put(buffers::touched_particles, touched);
    std::vector<gpu::Detection> state{detection()};
    state[0].touchings = static_cast<std::uint32_t>(touched.size());
    state[0].touched = {(state[0].touchings + 63) / 64, 1, 1};
    put(buffers::detection, state);
  }
  void slide() {
    for (std::uint32_t round = 0; round < WEFT_SLIDES; ++round)
      for (const char* pass : {"contact_slide", "contact_slide_apply"}) run(pass);
  }
  void limit() {
    run("contact_unsafe");
    for (int round = 0; round < static_cast<int>(WEFT_WIDE_ROUNDS); ++round) run("contact_limit", round);
    run("contact_limit_rest");
  }
  gpu::Detection detection() const { return get<gpu::Detection>(buffers::detection, 1).front(); }
  /// The least of all that contact_limit found.
  std::vector<double> step_fractions() const {
    std::vector<double> least;
    const auto rounds = get<std::array<std::uint32_t, 4>>(buffers::step_fractions, t_.x.size());
    for (const auto& f : rounds) least.push_back(std::bit_cast<float>(*std::ranges::min_element(f)));
    return least;
  }

  double recover = 0, quantum = 0;   // m

 private:
  const Tufts& t_;
};

// Kinematic particles stand still: for cloth between two that close on each other nothing can be promised.
inline Tufts violent_tufts(std::uint64_t seed, double violence) {
  Random random(seed);
  Tufts t = reference::tufts(random, 40, 12, violence);
  for (std::size_t i = 0; i < t.x.size(); ++i)
    if (t.inverse_masses[i] == 0) t.p[i] = t.x[i];
  return t;
}

}  // namespace weft
