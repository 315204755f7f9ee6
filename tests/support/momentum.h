// The momentum of cloth, and whether what it loses is what bodies are given.
#pragma once

#include <cmath>

#include "tests/support/ways.h"

namespace weft {

struct Sum {
  double x = 0, y = 0, z = 0;
  Sum& operator+=(const Sum& more) { return x += more.x, y += more.y, z += more.z, *this; }
  double size() const { return std::hypot(x, y, z); }
};

inline Sum momentum_of(const Simulation& simulation) {
  const auto positions = must(simulation.read_positions()), velocities = must(simulation.read_velocities());
  Sum sum;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (const double w = positions[i].w; w > 0) sum += {velocities[i].x / w, velocities[i].y / w, velocities[i].z / w};
  return sum;
}

inline double mass_of(const Simulation& simulation) {
  double mass = 0;
  for (const gpu::vec4& p : must(simulation.read_positions())) mass += p.w > 0 ? 1 / double(p.w) : 0;
  return mass;
}

/// Whether after every frame what cloth has gained and what colliders were given add up to what gravity gave.
inline void expect_balance(const compute::Device& device, Scene scene, int frames = 60, Way way = Way::advance) {
  scene.reactions = true;
  const auto simulation = must(Simulation::create(device, scene));
  const Sum start = momentum_of(*simulation);
  const double mass = mass_of(*simulation);
  Sum given;
  double exchanged = 0;
  for (int k = 1; k <= frames; ++k) {
    run_frame(device, *simulation, way);
    const Sum now = momentum_of(*simulation);   // waits
    const auto reactions = simulation->take_reactions();
    ASSERT_EQ(reactions.size(), scene.colliders.size());
    for (const Reaction& r : reactions) {
      given += {r.impulse.x, r.impulse.y, r.impulse.z};
      exchanged += double(length(r.impulse));
    }
    const double weight = mass * kFrame * k;
    const Sum missing{now.x - start.x + given.x - weight * double(scene.gravity.x), now.y - start.y + given.y - weight * double(scene.gravity.y),
                      now.z - start.z + given.z - weight * double(scene.gravity.z)};
    ASSERT_LT(missing.size(), 1e-4 * std::max(exchanged, mass))   // before anything is exchanged: rounding of velocities up to 1 m/s
        << "frame " << k << ": " << missing.x << ' ' << missing.y << ' ' << missing.z << " of " << exchanged << "; "
        << simulation->counts().truncated << " stopped short";
  }
  EXPECT_GT(exchanged, 0.5 * mass) << "the scene tests nothing";
}

}  // namespace weft
