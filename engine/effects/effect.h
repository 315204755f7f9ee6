// An effect is one declaration: what calls for it, what it cooks, its buffers, its passes, their specialization constants and uniform
// values, whether the reference has it, and what it reports. Its keys stand beside it (keys.h). list.h lists all effects.
//
// A scene that does not call for an effect has none of it: no pipeline, no byte, no dispatch. Where an effect is no pass of its own but a
// part of other passes (a tether is satisfied where the iteration ends), it is a constant that these are specialised to.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/counts.h"
#include "engine/effects/buffer.h"
#include "engine/effects/list.h"

namespace weft {

namespace cooking {
class CookState;
struct ClothInput;
}  // namespace cooking

enum class EffectId {
#define WEFT_ENUMERATE(name) name,
  WEFT_EFFECTS(WEFT_ENUMERATE)
#undef WEFT_ENUMERATE
};
#define WEFT_COUNT(name) +1
inline constexpr std::size_t kEffects = 0 WEFT_EFFECTS(WEFT_COUNT);
#undef WEFT_COUNT

/// When a pass runs; engine/solve/frame_program.h says how often.
enum class Stage { frame_begin, substep_begin, force, detect, assemble, linear, iteration, contacts, contact, slide, substep_end, frame_end };

/// Where the GPU writes how many workgroups an indirect dispatch has.
struct Arguments {
  const Buffer* buffer = nullptr;       // null: the CPU counts
  std::uint32_t offset = 0;             // bytes
};

/// How many threads a pass has.
struct Threads {
  Length count;                         // push.count
  Length groups = nullptr;              // of workgroups; null: as many as `count` threads need
  Arguments arguments = {};
  bool grows = false;                   // with the capacity for contacts
};

namespace threads {
inline constexpr Threads particles{lengths::particles}, vertices{lengths::vertices};
/// A single one; push.count is the number of particles.
inline constexpr Threads once{lengths::particles, lengths::one};
}  // namespace threads

/// Some of a pass's elements.
struct Range {
  std::uint32_t first = 0, count = 0;
};

/// What a pass changes that others must follow.
enum class Changes {
  nothing,
  iterate,      // writes the next iterate: `predicted` and `next_iterate` trade places after it
  velocity      // only by motion/force.glsl, which keeps the prediction in step
};

/// In which frames a pass is recorded that does what others do, too, to the bit, or that has nothing to do in others: those with few
/// contacts, or with many; those in which detections of contacts are seldom, or often; those that are calm, as detections are seldom,
/// contacts few and nothing can have gone through cloth, or stirred; those in which there were contacts when last was heard of them, as
/// else another pass ends the substep. In still ones (FrameInput::is_still) there is no detection, so none of its passes is recorded: not
/// what is `sought` in all others, either, but what decides and what prepares candidates, where there are any.
enum class Crowd { any, few, many, seldom, often, calm, stirred, met, sought, decided, prepared };

using Constants = std::array<std::uint32_t, gpu::constant::kCount>;

/// What a scene calls for, as far as its passes depend on it.
struct Needs {
  std::bitset<kEffects> effects;
  Constants constants{};
  std::uint32_t narrow = 0;                      // threads of a workgroup in passes with many small ones
  std::uint32_t alone = 0;                       // of the only one of a pass
  std::uint32_t crew = 0;                        // of one whose loops are as long as the scene is large
  std::uint32_t thin = 0;                        // in passes whose few threads have much to do, each another amount
  std::uint32_t storage_buffers = ~0u;           // that the device binds to a pass, at most
  bool has(EffectId effect) const { return effects[static_cast<std::size_t>(effect)]; }
};

struct Pass {
  const char* name;                              // of the shader in the effect's folder; in timings, labels and reports
  Stage stage;
  Threads threads;
  Changes changes = Changes::nothing;
  Crowd crowd = Crowd::any;
  bool can_finalize = false;                     // the last of these in an iteration ends it (motion/finalize.glsl)
  bool (*when)(const Needs&) = nullptr;          // null: always when the effect is called for
  const char* with_contacts = "";                // what its label ends in with contacts, which it watches, too
  bool collides = false;                         // puts particles out of colliders, which its label says then
  bool after_tethers = false;                    // these end the last pass before it
  bool only_towards_targets = false;             // skipped in frames in which no target moves; with contacts, where none is late either
  bool only_after_motion = false;                // skipped in frames in which no kinematic particle can move or has (FrameInput::kinematics_rest)
  std::uint32_t (*every)(const Cooked&) = nullptr;   // runs in each so many-th substep since the simulation's start; null: in all
  std::uint32_t (*sweeps)(const Needs&, float haste) = nullptr;   // done so often, with its neighbours that have them (haste.h); null: once
  std::uint32_t rounds = 1;                      // dispatches one after another; the round is in push.flags
  std::vector<Range> (*ranges)(const Cooked&) = nullptr;   // instead: a dispatch for each
  bool thin = false;                             // workgroups of Needs::thin threads
  bool a_workgroup_each = false;                 // not a thread: a workgroup, of Needs::narrow threads
  bool alone = false;                            // one workgroup, of Needs::alone threads, does it all
  bool crew = false;                             // that of Needs::crew threads: it has to go through all particles or contacts
  bool can_end_substep = false;                  // does what those of Crowd::met do where they are not recorded (WEFT_ENDS_SUBSTEP)
};

/// A slice of the uniform buffer, updated each frame, for all passes that read SLICE(..., name). The solver sets what changes while
/// running (Solver::set_uniforms).
struct Slice {
  std::string_view name = {};
  Contents (*first)(const Cooked&) = nullptr;
};

/// How the double-precision reference knows an effect.
enum class Reference {
  absent,       // not at all: comparisons refuse scenes with it
  modelled,     // it is among the reference's energies or motions
  a_way_to      // it is a method, and the reference reaches the same solution by another
};

/// A number that an effect reports: in report.json under its name, "contacts.max" in an object. One of the three is set.
struct Figure {
  const char* name;
  std::uint64_t (*cooked)(const CookedFabric&) = nullptr;
  std::uint64_t (*counted)(const Counts&) = nullptr;
  double (*measured)(const Counts&) = nullptr;
};

struct Effect {
  const char* name;
  const char* key = "";                          // by which a scene asks for it, for sentences
  bool (*called_for)(const Scene&, const CookedFabric&);
  std::span<const Buffer* const> buffers = {};
  std::span<const Pass> passes = {};
  const char* part_of_finalize = "";             // what a finalizing pass's label ends in with it
  void (*specialize)(const Cooked&, Constants&) = nullptr;
  Slice slice = {};
  Reference reference = Reference::absent;
  std::span<const Figure> figures = {};
  void (*remark)(const Counts&, std::vector<std::string>& remarks) = nullptr;   // sentences about a run, for people
  /// Cooks one cloth; then kinematic bodies, after all cloths; then the lists as the GPU reads them, when all particles are known.
  /// Errors are sentences without the cloth's path.
  Result<void> (*cook)(cooking::CookState&, const cooking::ClothInput&) = nullptr;
  Result<void> (*cook_bodies)(cooking::CookState&, std::span<const Mesh> collider_meshes) = nullptr;   // particles that are no cloth
  void (*lay_out)(cooking::CookState&) = nullptr;
  /// Makes its lists anew where they depend on who is held, when that has changed (held_anew). Lengths stay.
  void (*hold)(cooking::CookState&, std::span<const Mesh> meshes) = nullptr;
};

/// Each in its own folder.
namespace effects {
#define WEFT_DECLARE(name) extern const Effect name;
WEFT_EFFECTS(WEFT_DECLARE)
#undef WEFT_DECLARE
}  // namespace effects

/// In the order of list.h.
std::span<const Effect* const> all_effects();
inline const Effect& effect(EffectId id) { return *all_effects()[static_cast<std::size_t>(id)]; }

/// Every row, effect by effect.
std::span<const Buffer* const> all_buffers();
/// A row's number: its index among all_buffers(). Rows are identified by their address.
std::size_t number_of(const Buffer& row);
/// The row of that name; null where there is none.
const Buffer* buffer_named(std::string_view name);

Cooked cooked_of(const Scene& scene, const CookedFabric& fabric);

/// What a cooked scene calls for. `workgroup`, `through_texels` and what follows are the device's.
Needs needs_of(const Cooked& subject, std::uint32_t workgroup, bool through_texels, std::uint32_t narrow = 64, std::uint32_t alone = 128,
               std::uint32_t crew = 256, std::uint32_t thin = 8, bool idle_costs = false);

/// Why the reference cannot follow the scene, as a sentence that begins with the key; empty if it can.
std::string reference_fault(const Scene& scene, const CookedFabric& fabric);

}  // namespace weft
