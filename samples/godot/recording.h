// What runs in Godot as a scene for `weft run`: meshes, and the way of colliders and anchors, tick by tick.
//
// A pose lies between two keys at one time and the next time that a double can have. At a key's own time a scene takes the key as it is
// where the next key has its axis; from a key to one with another axis it would turn by quaternions, and round.
#pragma once

#include <filesystem>

#include "engine/simulation.h"

namespace weft_godot {

struct Tick;

class Recording {
 public:
  /// `meshes` as the simulation was made of them.
  Recording(std::filesystem::path folder, const weft::Simulation& simulation, std::vector<weft::Mesh> meshes);

  /// The poses at the end of a tick, at the simulation's time: of a collider without one that of the tick before, of anchors the first
  /// keys, of skins where bones are.
  void add(double time, const Tick& tick, const weft::Scene& anchors);
  /// Something happened that a scene cannot say.
  void spoil(std::string why);

  /// Writes scene.json, a GLB a mesh, and `digest`, that of the cloths' vertices. Errors: what cannot be written.
  weft::Result<void> write(const weft::Simulation& simulation) const;

 private:
  std::filesystem::path folder_;
  weft::Scene scene_;
  std::vector<weft::Mesh> meshes_;
  std::uint32_t ticks_ = 0;
  std::string spoilt_;
};

/// FNV-1a of the bits of positions, 16 hexadecimal digits.
std::string digest_of(std::span<const weft::Vec3> positions);

}  // namespace weft_godot
