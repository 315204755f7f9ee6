// The perturbations that test how robust a scene is: other frames, other masses, other places, worse starts.
//
// The physics is invariant under most of them, so they must change nothing: the same cloth heavier and as much stiffer, or only
// heavier if nothing in it gives way; the same scene elsewhere; everything larger (with gravity, so that it takes as long); cut
// into other frames, or set elsewhere between two. It is not invariant under a jolt, which must leave nothing behind.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene.h"

namespace weft::command {

struct Perturbation {
  std::string group;             // "rates": what several of a kind are called together
  std::string name;              // "frames at 30 Hz"
  double frame = 0;              // s, what the host asks for at a time; 0: 1 / rate
  double rate = 0;               // Hz, of the solver; 0: the scene's
  std::optional<std::uint32_t> seed = {};   // jitters the start
  double mass = 1, weight = 1, size = 1;   // factors: mass with all moduli, mass alone, lengths
  Vec3 away = {};                // m: where the scene is moved to
  double hitch = 0;              // s: a frame that long halfway through
  Vec3 jolt = {};                // m: anchors and colliders jump halfway through, within a frame
  Vec3 teleport = {};            // m: cloth, anchors and colliders are set there halfway through, between two frames
  double bands = 1;              // within how many bands mean and shape are at the end what they were without; infinite: not judged
  bool same_strain = true;       // strain at the end must be what it was without
};

/// All of them; `quick`: one or two of each kind. The pose under mass alone is judged only where the physics is invariant under it:
/// for cloth that neither stretches nor resists bending.
std::vector<Perturbation> all_perturbations(const Scene& scene, bool quick);

/// In fewer frames than this there is no time for what happens halfway: the hitch, clamped to the scene's longest advance.
std::uint32_t least_frames(const Scene& scene);

/// The scene as the perturbation has it from the start. `halfway` (s): when anchors and colliders jump, within `frame`. Of a teleport the
/// scene has only where keys lead to afterwards; who runs it must set everything there at `halfway`.
Scene perturbed(const Scene& scene, const Perturbation& perturbation, double halfway, double frame);

}  // namespace weft::command
