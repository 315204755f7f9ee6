// The one place where GPU memory is described: included by C++ and by every shader.
//
// A buffer has a number (its binding), a name and an element. A pass says in its shader which buffers it READs, WRITEs or
// GATHERs (random access, through a texel buffer where the device has one); reflection turns those lines into descriptor
// sets, barriers and the list of buffers that exist. Structs are in scalar layout and only hold 4-byte members, so both
// languages agree on every offset. SI units.
#ifndef WEFT_SHARED_H
#define WEFT_SHARED_H

//    binding  name            element   length          what
#define WEFT_BUFFERS(X)                                                                                                  \
  X(0,  positions,      vec4)     /* particles      xyz position at the substep's start (m), w inverse mass (1/kg) */    \
  X(1,  velocities,     vec4)     /* particles      xyz velocity that `predicted` was made with (m/s), w material index */ \
  X(2,  predicted,      vec4)     /* particles      xyz current iterate (m), w its share of a sum (stretch.comp) */       \
  X(3,  relaxed,        vec4)     /* particles      the next iterate: swaps with `predicted` after a relaxing pass */    \
  X(4,  stretch_rows,   uvec2)    /* particles      first link pair, number of links */                                  \
  X(5,  stretch_links,  uvec4)    /* link pairs     two links (pack_link) */                                             \
  X(6,  stretch_lambda, vec2)     /* link pairs     multipliers of both links */                                         \
  X(7,  bend_rows,      uvec2)    /* particles      first entry pair, number of entries */                               \
  X(8,  bend_entries,   uvec4)    /* entry pairs    (particle, coefficient as float bits) twice */                       \
  X(9,  bends,          Bend)     /* bends          stencils */                                                          \
  X(10, bend_lambda,    vec4)     /* bends          multiplier of each stencil */                                        \
  X(11, bend_impulses,  vec4)     /* bends          change of the multiplier */                                          \
  X(12, bend_uses,      uvec4)    /* use pairs      (bend, K times inverse mass as float bits) twice */                  \
  X(13, tethers,        uvec4)    /* particles x k  two tethers (anchor, reach as float bits), nearest first */          \
  X(14, anchors,        Anchor)   /* anchors        targets of this frame */                                             \
  X(15, colliders,      Collider) /* colliders      poses of this frame */                                               \
  X(16, materials,      vec4)     /* cloths         Material */                                                          \
  X(17, surface_rows,   uvec4)    /* vertices       particle, first corner, number of corners, unused */                 \
  X(18, corners,        uvec2)    /* corners        the triangle's two other particles, in order */                      \
  X(19, vertex_positions, vec4)   /* vertices       for the renderer: xyz, 1 */                                          \
  X(20, vertex_normals, vec4)     /* vertices       for the renderer: xyz, 0 */                                          \
  X(21, counters,       Counters) /* 1              what was mended while running */                                     \
  X(22, bend_use_rows,  uvec2)    /* particles      first use pair, number of uses */                                    \
  X(23, triangles,      uvec4)    /* triangles      three particles, unused: of cloths and of mesh colliders */          \
  X(24, edges,          uvec2)    /* edges          two particles: of those triangles, each once */                      \
  X(25, rest,           vec4)     /* particles      xyz rest position (m), w thickness (m) */                            \
  X(26, references,     vec4)     /* particles      xyz position at the last detection (m), w unused */                  \
  X(27, paths,          vec4)     /* particles      xyz what it would go from there in Detection::horizon substeps (m), w unused */ \
  X(28, leashes,        uint)     /* particles      how far it may stray from that path: a float's bits (m); 0: held */  \
  X(29, grid_counts,    uint)     /* slots          entries; all zero between detections */                              \
  X(30, grid_starts,    uint)     /* slots + 1      first entry */                                                       \
  X(31, grid_totals,    uint)     /* blocks         entries of a workgroup's slots */                                    \
  X(32, grid_entries,   vec4)     /* 3 x primitives xyz middle of its box (m), w bits: level << 28, and triangle or triangles + edge; \
                                                    xyz half sides, w away; xyz path, w step: its Outline (primitive.glsl) */ \
  X(33, detection,      Detection) /* 1             what detection and contacts tell each other */                       \
  X(34, candidates,     uvec4)    /* capacity       pairs that may meet before the next detection (pack_candidate) */    \
  X(35, contact_normals, vec4)    /* capacity       xyz from side B to side A, w distance to keep (m); w < 0: none (contact_prepare). \
                                                    During a detection near_edges: uvec2, two edges near each other */   \
  X(36, contact_weights, vec4)    /* capacity       barycentric, side A's above 0 and side B's below. \
                                                    During a detection near_faces: uvec2, particle and triangle */       \
  X(37, contact_counts, uint)     /* particles      contacts of this substep; 0 between substeps */                      \
  X(38, contact_sums,   ivec4)    /* particles      xyz sum of corrections in units of `quantum`, w unused; 0 between iterations */ \
  X(39, fractions,      uvec4)    /* rounds / 4 x particles  bits of the fraction of its way it may go, a round each; 1.0 between substeps */ \
  X(40, spring_rows,    uvec2)    /* particles      first four of springs, number of fours */                            \
  X(41, spring_ends,    uvec4)    /* fours          other particles of four springs; its own number where there is none */ \
  X(42, springs,        vec4)     /* 4 x fours      rest length (m), stiffness (N/m), damping (N s/m), 1 if it only pulls */ \
  X(43, spring_blocks,  vec4)     /* 4 x fours      a spring's 3x3 block in this substep: xyz u, w a of u u^T + a I (kg) */ \
  X(44, inverses,       vec4)     /* 2 x particles  inverse Cholesky factor of the diagonal block: xx yy zz, mass (kg; 0: held); yx zx zy, unused */ \
  X(45, exchanged,      vec4)     /* particles x 1 or 3  what particles tell each other in a solve: preconditioned residuals, or Jacobi's last iterates (m/s) */ \
  X(46, krylov,         vec4)     /* particles x 5 or 1  residual (kg m/s); of conjugate gradients also change (m/s), product, search direction, its image */ \
  X(47, partial_sums,   vec4)     /* particles      sums of workgroups (implicit.glsl) */                                \
  X(48, linear,         Linear)   /* 1              where the solve is */                                                \
  X(49, free_cloths,    FreeCloth) /* cloths        whose momentum a solve must not change */           \
  X(50, coloured_links, uvec4)    /* links          colour after colour (pack_coloured) */                               \
  X(51, coloured_lambda, uint)    /* links          bits of their multipliers */                                           \
  X(52, stretch_steps,  vec2)     /* link pairs     what both multipliers last changed by (Chebyshev) */                 \
  X(53, bend_steps,     vec4)     /* bends          what the multiplier last changed by */                               \
  X(54, iterates,       vec4)     /* 3 x particles  the iterate before the last, the last (m), and the substep's first step (m) */ \
  X(55, acceleration,   Acceleration) /* 1          whether Chebyshev's acceleration is steady */                          \
  X(56, contact_list,   uint)     /* capacity       the candidates that touch, later those that could cross (contact_list.glsl) */ \
  X(57, contact_lacks,  uint)     /* particles      what its contacts lack, together (contact_share.glsl); 0 between iterations */ \
  X(58, hinges,         Hinge)    /* hinges         edges that bend about an angle */                                    \
  X(59, hinge_impulses, vec4)     /* 4 x hinges     of each of its particles: xyz gradient times change of the multiplier; the first's w: the multiplier */ \
  X(60, hinge_use_rows, uvec2)    /* particles      first use pair, number of uses */                                    \
  X(61, hinge_uses,     uvec4)    /* use pairs      (4 x hinge + which of its particles, inverse mass as float bits) twice */  \
  X(62, walls,          vec4)     /* 2 x particles  what colliders decide of an implicit substep (implicit_wall.glsl) */

// Texel views (GATHER) live in a second descriptor set under the same numbers.
#define WEFT_STORAGE_SET 0
#define WEFT_TEXEL_SET 1

#ifdef __cplusplus

#include <bit>
#include <cstdint>
#include <type_traits>

namespace weft::gpu {
using uint = std::uint32_t;
struct uvec2 { uint x, y; };
struct uvec4 { uint x, y, z, w; };
struct ivec4 { int x, y, z, w; };
struct vec2 { float x, y; };
struct vec3 { float x, y, z; };
struct vec4 { float x, y, z, w; };
#define WEFT_INLINE inline
#define WEFT_FLOAT(bits) std::bit_cast<float>(bits)
#define WEFT_BITS(value) std::bit_cast<std::uint32_t>(value)

#else

#extension GL_EXT_scalar_block_layout : require
#define WEFT_INLINE
#define WEFT_FLOAT(bits) uintBitsToFloat(bits)
#define WEFT_BITS(value) floatBitsToUint(value)

#define WEFT_BINDING(number, name, element) const uint name##_binding = number;
WEFT_BUFFERS(WEFT_BINDING)

#define WEFT_BUFFER(access, element, name) \
  layout(set = WEFT_STORAGE_SET, binding = name##_binding, scalar) restrict access buffer name##_block { element name[]; };
// Pairs that a search found near each other lie where the contacts will (two in a place, of each kind) until those are prepared.
const uint near_edges_binding = contact_normals_binding, near_faces_binding = contact_weights_binding;
#define READ(element, name) WEFT_BUFFER(readonly, element, name)
#define WRITE(element, name) WEFT_BUFFER(writeonly, element, name)
#define READ_WRITE(element, name) WEFT_BUFFER(, element, name)
#define SHARE(element, name) WEFT_BUFFER(coherent, element, name)   // workgroups of one dispatch read what others wrote

// A gather reads through texel buffers, which the software driver fetches twice as fast as it loads from storage buffers;
// that holds for the thread's own elements too. GATHER_STORAGE builds the other variant, for devices that prefer it or whose
// texel buffers are too short. GATHER_WRITE is for buffers whose elements a thread fetches and then writes itself.
#ifdef GATHER_STORAGE
#define GATHER(name) READ(vec4, name)
#define GATHER_UINT4(name) READ(uvec4, name)
#define GATHER_UINT2(name) READ(uvec2, name)
#define GATHER_UINT(name) READ(uint, name)
#define GATHER_WRITE(name) READ_WRITE(vec4, name)
#define FETCH(name, i) name[i]
#define FETCH_UINT2(name, i) name[i]
#define FETCH_UINT(name, i) name[i]
#else
#define WEFT_TEXELS(sampler, name) layout(set = WEFT_TEXEL_SET, binding = name##_binding) uniform sampler name##_texels;
#define GATHER(name) WEFT_TEXELS(samplerBuffer, name)
#define GATHER_UINT4(name) WEFT_TEXELS(usamplerBuffer, name)
#define GATHER_UINT2(name) WEFT_TEXELS(usamplerBuffer, name)
#define GATHER_UINT(name) WEFT_TEXELS(usamplerBuffer, name)
#define GATHER_WRITE(name) WEFT_TEXELS(samplerBuffer, name) \
  layout(set = WEFT_STORAGE_SET, binding = name##_binding, scalar) writeonly buffer name##_block { vec4 name[]; };
#define FETCH(name, i) texelFetch(name##_texels, int(i))
#define FETCH_UINT2(name, i) texelFetch(name##_texels, int(i)).xy
#define FETCH_UINT(name, i) texelFetch(name##_texels, int(i)).x
#endif

layout(local_size_x_id = 0) in;

#endif

/// Isometric bending stencil (Bergou et al. 2006): the edge (particle[0], particle[1]) and its opposite vertices.
struct Bend {
  uint particle[4];
  float k[4];         // K of the stencil: sums to 0
  float compliance;   // 1/(B q) (m^2/N m ... per unit of |l|^2)
  float split_weight; // sum n_j w_j K_j^2 (1/kg)
};

/// Bending about a rest angle (hinge.comp): the edge (particle[0], particle[1]) and its opposite vertices.
struct Hinge {
  uint particle[4];
  float weight[4];    // n_j w_j (1/kg)
  float rest_cosine, rest_sine;   // of the angle at rest, 0 where flat
  float compliance;   // rad^2/J
};

/// One-sided link to an anchor; anchor == WEFT_NONE ends a particle's list. Lists are padded to an even length.
struct Tether {
  uint anchor;        // particle that never moves by itself
  float reach;        // m
};

struct Anchor {
  uint particle;
  vec3 from;          // m, at the frame's start
  vec3 to;            // m, at its end
};

// The buffer holds all planes, then all spheres, capsules and boxes. How many of each is a specialisation constant: a scene
// that has none of a shape has no code for it either. Where two overlap, the later has the last word.
#define WEFT_PLANE 0
#define WEFT_SPHERE 1
#define WEFT_CAPSULE 2
#define WEFT_BOX 3
#define WEFT_SHAPES 4
#define WEFT_SHAPE_CONSTANT 1   // the first of their constants; 0 is the width of a workgroup

// Pairs of links in every row of stretch_links; 0 where stretch_rows has to tell.
#define WEFT_STRIDE_CONSTANT 5

// How the equations of an implicit substep are solved.
#define WEFT_LINEAR_CONSTANT 6
#define WEFT_LINEAR_CG 0u
#define WEFT_LINEAR_JACOBI 1u

// Whether any spring of the pass spring is damped.
#define WEFT_DAMPED_CONSTANT 7

struct Collider {
  float radius;       // m, spheres and capsules
  float friction;     // Coulomb
  vec3 centre_from, centre_to;   // m
  vec3 normal_from, normal_to;   // unit, planes
  vec3 spin;          // rad over the frame, about the centre: where capsules and boxes end follows from it
  vec4 rotation_from; // unit quaternion, capsules and boxes
  vec3 half_size;     // m: half a box's sides; y: half a capsule's length
};

struct Material {
  float keep;         // fraction of the velocity that a substep keeps: exp(-damping h)
  float friction;     // Coulomb
  float thickness;    // m
  float unused;       // a material is one texel
};

// What the first steps of a substep's iteration tell of its predecessors' (accelerate.glsl): bits of squares (m^2), substeps by turns.
struct Acceleration {
  uint largest[3];    // of all steps
  uint turned[3];     // of those that point the other way than the substep before
  uint streak[3];     // for how many substeps on end that has grown
  uint rest[3];       // for how many more substeps there is no acceleration
};

struct Counters {
  uint non_finite;    // particles put back to their last finite position
  uint coincident;    // links whose ends were at one place
  uint contacts_most; // candidates that one detection found, at most
  uint contacts_lost; // candidates that found no place, all detections together
  uint truncated;     // times that a particle was stopped short: by a plane, its leash or a lost candidate, the latter two perhaps several times a substep; anchors only by a plane
  uint detections;
  uint lag;           // bits of a float (m): how far cloth held an anchor back from its target, at most, at a substep's start
  uint unconverged;   // implicit solves that left more than WEFT_CONVERGED of the residual
  uint stopped;       // implicit solves that broke off with the best there was
  float residual;     // the last implicit solve's, over that of the free flight
  uint unaccelerated; // substeps that fell back from Chebyshev to Jacobi
};

// A solve counts as converged when no more than this is left of its residual, in the norm r . D^-1 r.
#define WEFT_CONVERGED 0.01

/// A cloth, and the velocity that a solve gave to its centre of mass though no spring could.
struct FreeCloth {
  uint first, particles;   // no particles where something holds it
  vec3 drift;              // m/s
};

/// Where the solve of an implicit substep is (implicit.glsl).
struct Linear {
  float first;        // r . D^-1 r of the free flight
  float squared;      // ... before the last iteration
  float gamma;        // r . z of the last iteration
  float step;         // how far it went along its direction
  float next;         // how much of the direction before goes over into this one; Jacobi: what its iterate is to be multiplied by
  uint iterate;       // Jacobi: which of the three is the best so far
  uint done;          // 1: nothing more to gain, 2: broken off
  uint arrived;       // workgroups of the dispatch at hand that have summed up; 0 between dispatches
};

/// Arguments of an indirect dispatch.
struct Groups {
  uint x, y, z;
};

// A box goes to the level of the grid whose cells are at least as long as it: cell * 2^level.
#define WEFT_LEVELS 16

#define WEFT_HORIZON 10u   // substeps, at most, that paths lead
#define WEFT_ROUNDS 16u    // of contact_limit, a multiple of four: a particle has a fraction for each

// Detection looks for pairs that can come within their distance while every particle stays on a leash about the straight path
// that it was on when they were detected (detect_path.comp says why that loses nothing). The group counts let the GPU itself
// decide whether there is anything to do.
struct Detection {
  Groups particles, primitives, blocks;   // of the detection's passes; no groups where none is due
  Groups near_faces, near_edges;          // a thread a pair that a search found near
  Groups contacts;    // a thread a candidate
  Groups listed[2];   // a thread a candidate that touches, and one that could cross
  Groups touched;     // a thread a particle, where there are candidates
  uint due;           // the next substep begins with a detection
  uint age;           // substeps since the last one, at most WEFT_HORIZON
  uint horizon;       // substeps that its paths lead
  uint candidates;    // that it found; more than push.capacity: the rest were lost
  float reach;        // m, the leashes' length
  uint listings[2];   // candidates that touch in this substep, and those that could cross at its end
  uint lowered[WEFT_ROUNDS - 1];   // some particle's fraction was lowered in this round (contact_limit.comp)
  uint unsafe;        // ... and the last round still found a pair to cross: the static planes hold
  uint calm;          // the last detection found the particles at the end of paths that nobody had left
  uint near[2];       // pairs that the search found: of particles and triangles, then of edges
  uint levels[2];     // a bit for each level that has boxes, of triangles, then of edges
  uint extents[2 * WEFT_LEVELS];   // bits of the longest half side of a box (m) at each level, of triangles, then of edges
};
#define WEFT_TOUCHING 0u
#define WEFT_OPEN 1u
#define WEFT_NEAR 2u   // pairs of each kind that may be near each other, for each candidate that there is room for

/// What every pass is told. 112 of the 128 bytes that every device has.
struct Push {
  uint count;         // threads with work
  uint tether_pairs;  // per particle
  uint flags;         // WEFT_LAST_ITERATION ...
  float h;            // s, substep
  float inverse_h;    // 1/s
  float inverse_h2;   // 1/s^2
  float relaxation;   // omega
  float fraction_from, fraction_to;   // of the frame, at this substep's start and end
  vec3 gravity;       // m/s^2
  // Contacts only.
  uint triangles, edges;   // how many; together the grid's primitives
  uint slots;         // of the grid, a power of two
  uint capacity;      // candidates
  float cell;         // m, at level 0
  float quantum;      // m, unit of contact_sums
  float recover;      // m: what a substep makes good of a distance that is too small
  float patience;     // times a thickness (anchor.comp) or the distance that a pair keeps (contact_limit.comp): how far behind its target cloth may hold an anchor
  float reach_low, reach_high;   // m, limits of Detection::reach
  // The method implicit only.
  uint iteration;     // of the solve; after it, how many there were
  float momentum;     // Chebyshev's weight of this iteration (accelerate.glsl)
  uint first;         // of `coloured_links`: where this dispatch's colour begins
  vec3 origin;        // m: what is added to particles' positions for the renderer
};

#define WEFT_LAST_ITERATION 1u  // of the substep: velocities follow
#define WEFT_LAST_SUBSTEP 2u    // of the frame: no further prediction
#define WEFT_FIRST_ITERATION 4u // of the substep: multipliers start at zero
#define WEFT_ROUND_SHIFT 8u      // bits 8 to 11: which round of a pass that runs in several
#define WEFT_TURN_SHIFT 16u      // bits 16 and 17: substeps modulo 3


#define WEFT_NONE 0xffffffffu
#define WEFT_MAX_PARTICLES 0x00ffffffu

#ifdef __cplusplus

static_assert(sizeof(Bend) == 40 && sizeof(Hinge) == 44 && sizeof(Tether) == 8 && sizeof(Anchor) == 28 && sizeof(Collider) == 96);
static_assert(sizeof(Material) == 16 && sizeof(Counters) == 44 && sizeof(Push) == 112 && sizeof(Linear) == 32 && sizeof(FreeCloth) == 20 && sizeof(Detection) == 348);
static_assert(sizeof(Acceleration) == 48);
static_assert(std::is_trivially_copyable_v<Push>);

enum Binding : uint {
#define WEFT_ENUMERATE(number, name, element) name = number,
  WEFT_BUFFERS(WEFT_ENUMERATE)
#undef WEFT_ENUMERATE
};

}  // namespace weft::gpu

#endif

#include "packed.h"

#endif
