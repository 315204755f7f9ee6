// What a script does to cloth while it is simulated: pins and grabs. The render thread's.
//
// The engine numbers grabs from 0, and a simulation that is made anew knows of none. Here a grab keeps its number as long as it holds, and
// pins stay, whatever comes and goes in the tree.
#pragma once

#include <map>
#include <set>

#include "engine/simulation.h"

namespace weft_godot {

/// One thing that is done between two ticks.
struct Hand {
  enum class Does { pin, release, move_pins, move_grab, let_go };
  Does what = Does::pin;
  std::uint32_t cloth = 0;                    // its place in the simulation
  std::vector<std::uint32_t> vertices = {};   // of the cloth, as get_vertices() has them
  std::vector<weft::Vec3> targets = {};       // m, world space
  std::int64_t grab = 0;
};

class Hands {
 public:
  /// Errors: what the simulation refuses; a grab that does not hold.
  weft::Result<void> act(weft::Simulation& simulation, const Hand& hand);
  /// Takes hold where a ray first meets cloth: its number, from 1 on, and where. Nothing where the ray meets none.
  struct Held {
    std::int64_t number;
    weft::Grabbed at;
  };
  weft::Result<std::optional<Held>> grab(weft::Simulation& simulation, weft::Vec3 origin, weft::Vec3 direction, const weft::Grip& grip);

  /// Whether a hand has moved or released what this anchor holds: nodes do not move it any more.
  bool have(const weft::Simulation& simulation, const weft::AnchorTarget& anchor) const;

  /// Does the same to a simulation whose cloth is where it was in the last. Cloth that is not carried over is let go.
  weft::Result<void> carry(const Hands& from, weft::Simulation& to, std::span<const std::optional<std::uint32_t>> carried);

 private:
  struct Grab {
    std::uint32_t number = 0, cloth = 0;
    weft::Grip grip;
    weft::Vec3 target;
  };
  using Points = std::set<std::pair<std::uint32_t, std::uint32_t>>;   // cloth, point of its mesh
  Points pinned_, released_, moved_;
  std::map<std::int64_t, Grab> grabs_;
  std::int64_t last_ = 0;
};

}  // namespace weft_godot
