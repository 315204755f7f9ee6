// What the GPU tests of detection share: soups of triangles as a scene, and a solver in which one detection has run over them.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "engine/effects/contact/clusters.h"
#include "shaders/contact/detect.ref.h"
#include "tests/support/single_pass.h"

namespace weft {

inline constexpr double kMargin = 0.004;   // m

struct Soup {
  CookedFabric fabric;
  std::vector<gpu::vec4> predicted;
};

inline gpu::vec4 sum(const gpu::vec4& a, const gpu::vec4& b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w}; }
inline gpu::vec4 times(float s, const gpu::vec4& a) { return {s * a.x, s * a.y, s * a.z, a.w}; }

// A fabric with contacts that has nothing but particles and triangles.
inline Soup soup_of(Random& random, std::uint32_t particles) {
  SolverSettings solver;
  solver.substeps = 1;
  Soup soup{loose_particles(random, particles, solver), {}};
  soup.fabric.materials.assign(3, soup.fabric.materials[0]);
  for (std::size_t k = 0; k < 3; ++k) soup.fabric.materials[k].body = static_cast<float>(k);
  for (const gpu::vec4& x : soup.fabric.positions) soup.fabric.rest.push_back({x.x, x.y, x.z, 0.003f});
  soup.predicted = soup.fabric.positions;
  return soup;
}

inline void add_triangle(Soup& soup, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  soup.fabric.triangles.push_back({a, b, c});
  const std::uint32_t corners[] = {a, b, c};
  for (int k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax(corners[k], corners[(k + 1) % 3]);
    const auto same = [low = low, high = high](gpu::uvec2 e) { return e.x == low && e.y == high; };
    if (low != high && std::none_of(soup.fabric.edges.begin(), soup.fabric.edges.end(), same)) soup.fabric.edges.push_back({low, high});
  }
}

// Triangles of three decades in size, three cloths, every third sharing an edge with the one before; one cloth is held, as a
// mesh collider is. They drift together, by cloth, and each particle goes its own way besides. Rest poses are near the poses
// at hand, so that they limit the separation of some pairs.
inline Soup random_soup(Random& random, std::uint32_t triangles) {
  Soup soup = soup_of(random, 3 * triangles);
  const gpu::vec4 drift[] = {anywhere(random, 0.02, 0), {0, 0, 0, 0}, anywhere(random, 0.002, 0)};
  gpu::vec4 middle{};
  double size = 0;
  for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
    const std::uint32_t triangle = i / 3, cloth = triangle / 3 % 3;
    if (i % 3 == 0) {
      middle = anywhere(random, 0.4, 0);
      size = std::pow(10, between(random, -3, -0.3));
    }
    const gpu::vec4 x = sum(middle, anywhere(random, size, 0));
    soup.fabric.positions[i] = {x.x, x.y, x.z, cloth == 1 ? 0 : soup.fabric.positions[i].w};
    soup.fabric.velocities[i].w = std::bit_cast<float>(cloth);
    const gpu::vec4 rest = sum(x, anywhere(random, 0.003, 0));
    soup.fabric.rest[i] = {rest.x, rest.y, rest.z, 0.002f + 0.002f * static_cast<float>(cloth)};
    soup.predicted[i] = sum(soup.fabric.positions[i], sum(drift[cloth], anywhere(random, std::pow(10, between(random, -5, -2)), 0)));
    if (i % 3 != 2) continue;
    if (triangle % 3 == 1) add_triangle(soup, i - 2, i - 4, i - 3);
    else add_triangle(soup, i - 2, i - 1, i);
  }
  return soup;
}

struct Setting {
  bool gather_storage = false;
  std::uint32_t workgroup = 64;
  double cell = 0.05, margin = kMargin;
  std::uint32_t capacity = 1 << 18;
  double fastest = 0;   // m: the longest step of a kinematic particle, as the anchor pass finds it
  bool untangle = false;
  bool seldom = false;   // by the passes for detections that are seldom
  bool united = false;   // those search for both kinds of pairs, and so do these
  bool calm = false;     // by those for cloth of which little is to be expected, which are seldom as well
};

inline CookedFabric with_clusters(CookedFabric fabric) {
  fabric.own.of<ClusterLists>() = cooking::make_clusters(fabric);
  return fabric;
}

/// A solver in which one detection has run, up to and including the pass `last`.
struct Detected {
  CookedFabric fabric;
  SinglePass passes;
  const Soup& soup;

  static Scene scene(const Setting& setting) {
    Scene scene = loose_scene(1);
    scene.contacts.enabled = true;
    scene.contacts.capacity = setting.capacity;
    scene.contacts.cell = setting.cell;
    scene.contacts.untangle = setting.untangle;
    scene.contacts.detection_margin = setting.margin;
    return scene;
  }
  Detected(const compute::Device& device, const Soup& of, const Setting& setting, std::string_view last = "pair_edges")
      : fabric(with_clusters(of.fabric)),
        passes(device, scene(setting), fabric, setting.gather_storage, setting.workgroup, !setting.seldom && !setting.united && !setting.calm),
        soup(of) {
    FrameInput input = frame_of(1);
    input.seldom_detections = setting.seldom || setting.calm;
    input.few_contacts = input.kinematics_rest = setting.calm;
    passes.begin(input);
    passes.put(buffers::predicted, soup.predicted);
    gpu::Detection before = detection();
    before.fastest = std::bit_cast<std::uint32_t>(static_cast<float>(setting.fastest));
    passes.put(buffers::detection, std::vector{before});
    for (const std::string_view name : passes_of(setting)) {
      passes.run(name);
      if (name == last) break;
    }
  }
  static std::vector<std::string_view> passes_of(const Setting& setting) {
    if (setting.calm) return {"detect_alone", "detect_prepare"};
    if (setting.seldom) return {"detect_alone", "detect_search", "detect_pair"};
    std::vector<std::string_view> names{"detect_arguments", "detect_track", "cluster_box", "grid_fill", "grid_search"};
    if (setting.united)
      names.insert(names.end(), {"detect_outline", "detect_search", "detect_pair"});
    else
      names.insert(names.end(), {"outline_particles", "outline_faces", "outline_edges", "search_faces", "search_edges", "search_rare",
                                 "pair_faces", "pair_edges"});
    return names;
  }
  gpu::Detection detection() const { return passes.get<gpu::Detection>(buffers::detection, 1).front(); }
  std::vector<gpu::Candidate> candidates(std::uint32_t count) const {
    std::vector<gpu::Candidate> all;
    for (const gpu::uvec4& packed : passes.get<gpu::uvec4>(buffers::candidates, count)) all.push_back(gpu::unpack_candidate(packed));
    return all;
  }
  // The twin takes the GPU's trajectories, which have a test of their own.
  reference::Tracks tracks() const {
    reference::Tracks t;
    t.references = points(passes.particles(buffers::detected_positions));
    t.paths = points(passes.particles(buffers::trajectories));
    t.rest = points(soup.fabric.rest);
    for (const gpu::vec4& rest : soup.fabric.rest) t.thickness.push_back(rest.w);
    t.inverse_masses = inverse_masses(soup.fabric);
    for (const gpu::vec4& v : soup.fabric.velocities) t.cloth.push_back(std::bit_cast<std::uint32_t>(v.w));
    for (const gpu::vec4& trajectory : passes.particles(buffers::trajectories)) t.bounds.push_back(trajectory.w);
    return t;
  }
};

}  // namespace weft
