// The table of passes, and the plan that a scene makes of it.
//
// A pass is a row: a shader, when it runs, over what, and which features the scene must have. plan() keeps the rows that the
// scene calls for and reflects their shaders; what those touch is the list of buffers, of bindings and of barriers. An effect
// that a scene does not call for therefore has no pipeline, no byte and no dispatch. No Vulkan here.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compute/reflect.h"
#include "compute/result.h"
#include "engine/fabric.h"
#include "engine/scene.h"

namespace weft {

namespace feature {
inline constexpr std::uint32_t kPlain = 0;
inline constexpr std::uint32_t kAnchors = 1;
inline constexpr std::uint32_t kBending = 2;
inline constexpr std::uint32_t kTethers = 4;
inline constexpr std::uint32_t kColliders = 8;
inline constexpr std::uint32_t kIterated = 16;   // more than one iteration a substep: multipliers are kept
inline constexpr std::uint32_t kContacts = 32;   // cloth against cloth and mesh colliders
inline constexpr std::uint32_t kImplicit = 64;   // springs by implicit Euler instead of links and bends
inline constexpr std::uint32_t kRelaxed = 128;   // ... solved by Jacobi instead of conjugate gradients
// With kImplicit, solvers other than Jacobi: at most one of them.
inline constexpr std::uint32_t kGaussSeidel = 256;
inline constexpr std::uint32_t kChebyshev = 512;   // with kIterated
inline constexpr std::uint32_t kSprings = 1024;   // springs by symplectic Euler or Verlet instead of links and bends
inline constexpr std::uint32_t kHinges = 4096;   // bending about a mesh's own angles
}  // namespace feature

// assemble and linear: of an implicit substep, which has one iteration with many of `linear` before it; contact: several times an iteration
enum class Stage { frame_begin, substep_begin, detect, assemble, linear, iteration, contact, substep_end, frame_end };

/// One thread per. The later ones are dispatched with group counts that the GPU itself writes into gpu::Detection, none where
/// there is nothing to do.
enum class Domain {
  particles, anchors, bends, hinges, vertices, once,
  cloths,                                         // a workgroup, not a thread, per
  coloured,                                       // links of one colour, a dispatch a colour
  detected_particles, primitives, slots,          // where a detection is due
  near_faces, near_edges,                         // where it found pairs that are near each other
  candidates, touched_particles,                  // where the last detection found something
  contacts, open_candidates                       // those of the candidates that touch, and that could cross
};

struct Pass {
  const char* name;        // in timings, labels and reports; what a pass is fused with is appended
  const char* shader;
  Stage stage;
  Domain domain;
  std::uint32_t needs;     // features the scene must have ...
  std::uint32_t without;   // ... and must not have
  bool relaxes;            // writes the next iterate: `predicted` and `relaxed` swap afterwards
  bool settles;            // can end the iteration: the last of these does, fused with tethers, colliders and, without contacts, the velocity (settle.glsl)
  const char* fused = "";  // with contacts: what the shader's name ends in
  std::uint32_t rounds = 1;   // dispatches one after another; the round is in push.flags
};

/// Every pass there is, in the order in which they run within their stage.
std::span<const Pass> all_passes();

/// What a cooked scene calls for.
std::uint32_t features_of(const Scene& scene, const CookedFabric& fabric);

struct PlannedPass {
  const Pass* pass = nullptr;
  std::string label;                     // "bend+tether+settle": all that the dispatch does
  std::span<const std::uint32_t> spirv;
  std::uint64_t reads = 0, writes = 0;   // bit per gpu::Binding
  std::uint64_t storage = 0, texels = 0; // bindings used as storage and as texel buffers
  std::uint32_t group_size_constant = 0; // id of the specialisation constant for the workgroup's width
};

struct Plan {
  std::vector<PlannedPass> passes;
  std::uint64_t storage = 0;   // bindings used as storage buffers, over all passes
  std::uint64_t texels = 0;    // bindings used as texel buffers
  std::uint64_t buffers() const { return storage | texels; }
};

/// `gather_storage` takes the variants that gather through storage buffers.
/// Errors: a shader that is not there or touches what shared.h does not list; never for the table as it is.
Result<Plan> make_plan(std::uint32_t features, bool gather_storage);

/// A buffer of shared.h as a scene needs it.
struct BufferNeed {
  const char* name;
  gpu::Binding binding;
  std::uint64_t bytes;
  enum class Texel { float4, uint4, uint2, uint1, none } texel;   // what a fetch returns
  bool grows;              // with the room for candidates, while running
};

/// The numbers that contact passes run with.
struct ContactSizes {
  std::uint32_t slots = 0;      // of the spatial hash, a power of two
  std::uint32_t capacity = 0;   // candidates
  float cell = 0;               // m
  float reach_low = 0, reach_high = 0;   // m: leashes
  float quantum = 0;            // m: unit of summed corrections
  float recover = 0;            // m a substep
  float patience = 0;           // thicknesses
};
/// From the scene's settings, or from the mean edge and the thickness where those say 0.
ContactSizes contact_sizes(const Scene& scene, const CookedFabric& fabric);

/// All buffers with the sizes this fabric gives them, in the order of bindings; those the plan does not use are left out.
std::vector<BufferNeed> buffer_needs(const Plan& plan, const Scene& scene, const CookedFabric& fabric, const ContactSizes& contacts);

/// Threads of a domain.
std::uint32_t domain_size(Domain domain, const CookedFabric& fabric, const ContactSizes& contacts);

/// Dispatches that a pass takes where it is listed once.
std::uint32_t rounds_of(const Pass& pass, const CookedFabric& fabric);

/// Where in gpu::Detection a domain's group counts are, in bytes; nothing for those that the CPU counts.
std::optional<std::uint32_t> indirect_offset(Domain domain);

}  // namespace weft
