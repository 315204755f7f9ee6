// What C++ and shaders share: the structs in GPU memory, the constants that specialise a pass, push constants and uniforms.
//
// A pass says in its shader, by name, which buffers it READs, WRITEs or GATHERs (random access, through a texel buffer where the device
// has a fast one). Nobody numbers them: the compiler does, and reflection finds them again by their names. Descriptor sets, barriers and
// the list of buffers that exist all follow from those lines. A buffer's row (element, length, first contents, lifetime) stands in the
// effect that owns it, in engine/effects/. SI units.
//
// Structs have the layouts of Vulkan 1.1, std430 in storage buffers and push constants and std140 in uniform buffers, and the same in C++,
// where members are aligned to 4 bytes and those that are WEFT_ALIGNED to 16. So a vec3 or a vec4 stands where 16 divides the offset, a
// uvec2 where 8 does. Where it does not, its place is taken by packed_vec3 and the like, which the shader unpacks: three loads in place of
// one, for what is read once a frame or by few threads. A pass whose elements are of another size than in C++ is refused
// (engine/solve/plan.cpp).
#ifndef WEFT_SHARED_H
#define WEFT_SHARED_H

// What a pass is specialised to when a simulation is created. Each is folded into the code before the driver sees it: what is off has
// neither an instruction nor a binding.
//      id type  name
#define WEFT_CONSTANTS(X)                                                                                              \
  X(0,  uint, workgroup)        /* threads of a workgroup */                                                                 \
  X(1,  bool, through_texels)   /* 1: gathers go through texel buffers, 0: through storage buffers */                        \
  X(2,  bool, finalizes)        /* 1: the pass ends the iteration (motion/finalize.glsl) */                                  \
  X(3,  bool, is_iterated)      /* 1: more than one iteration a substep, so that multipliers are kept */                     \
  X(4,  bool, is_accelerated)   /* 1: by Chebyshev's iteration (chebyshev/chebyshev.glsl) */                                \
  X(5,  uint, tether_pairs)     /* of tethers, per particle, where the pass ends in them; 0: none */ \
  X(6,  bool, has_colliders)    /* 1: with a signed distance */                                                              \
  X(7,  bool, has_contacts)     /* 1: substeps end in contact_finalize */                                                    \
  X(8,  uint, planes)           /* colliders of this shape, and so on */                                                     \
  X(9,  uint, spheres)                                                                                                       \
  X(10, uint, capsules)                                                                                                      \
  X(11, uint, boxes)                                                                                                         \
  X(12, uint, stretch_stride)   /* link pairs in every row; 0: stretch_rows tell */                                          \
  X(13, bool, has_damping)      /* 1: some spring is damped */                                                               \
  X(14, uint, linear_solver)    /* WEFT_LINEAR_..., of the method implicit */                                                \
  X(15, uint, triangles_collide)   /* 1: with boxes, 2: with spheres and capsules, too (triangle_collide.comp) */             \
  X(16, bool, has_levels)       /* 1: coarse ones (level/level.glsl) */                                                      \
  X(17, bool, has_wide_levels)  /* 1: of more than WEFT_LOW_LEVEL nodes (level_wide.comp) */                                \
  X(18, bool, untangles)        /* 1: edges that go through triangles are looked for (untangle/crossing.glsl) */              \
  X(19, uint, air_wave_count)   /* gusts and eddies: a constant, because unrolled they take a third of the time */           \
  X(20, uint, air_stride)       /* pairs in every row of air_fans; 0: air_rows tell */  \
  X(21, uint, air_field_count)  /* of air_fields */ \
  X(22, uint, motion_constraints)   /* 1: with max distances, 2: with backstops, too */ \
  X(23, bool, skins_move_anchors)   /* 1: or mesh colliders */ \
  X(24, bool, has_pins)         /* 1: the host may pin and release particles (anchor.comp) */ \
  X(25, uint, grab_count)       /* of grabs */ \
  X(26, bool, reacts)           /* 1: what colliders are given is added up (reaction/reaction.glsl) */ \
  X(27, bool, has_lee)          /* 1: colliders or cloths have wakes in the air (air/wake.glsl) */ \
  X(28, bool, has_maps)         /* 1: a cloth has several materials (Maps) */ \
  X(29, uint, air_every)        /* substeps from one look at the air to the next (air/air.comp) */ \
  X(30, bool, has_tapered)      /* 1: some capsule's ends have two radii (collide/round_cone.glsl) */ \
  X(31, bool, has_body_masks)   /* 1: some collider does not meet every cloth (collide/mask.glsl) */ \
  X(32, uint, contact_mask_words)   /* in a row of contact_masks; 0: every cloth meets every other and every mesh (contact/mask.glsl) */ \
  X(33, bool, resizes)          /* 1: the host may resize some collider (collide/colliders.glsl) */ \
  X(34, uint, morphs)           /* 1: morph targets move points of skins, 2: and turn their normals (skin/skin.comp) */ \
  X(35, bool, takes_targets)    /* 1: the host may say in a buffer where points of skins are (skin/host_targets.glsl) */ \
  X(36, uint, first_mesh_body)  /* the body number of the first mesh collider (motion/body.glsl); 0: none is told what it is given (reaction/mesh.glsl) */ \
  X(37, uint, wake_count)       /* cloths and mesh colliders that have wakes in the air (air/wake.comp) */ \
  X(38, bool, has_supports)     /* 1: what colliders hold weighs more against them in the solve (support/support.glsl) */ \
  X(39, bool, is_second_order)  /* 1: in time (bdf2/bdf2.glsl) */ \
  X(40, bool, meets_meshes)     /* 1: cloth meets mesh colliders (tether/tether.glsl) */ \
  X(41, bool, idle_costs)       /* 1: threads that have nothing to do go through all of a shader, as on the software driver (contact/contact_alone.comp) */

#define WEFT_LINEAR_CG 0u
#define WEFT_LINEAR_JACOBI 1u

// Resources of a pass: storage and uniform buffers in one descriptor set, texel buffers in the other.
#define WEFT_STORAGE_SET 0
#define WEFT_TEXEL_SET 1

#ifdef __cplusplus

#include <bit>
#include <cstddef>
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
using packed_uvec2 = uvec2;
using packed_vec3 = vec3;
using packed_vec4 = vec4;
#define WEFT_ALIGNED alignas(16)
#define WEFT_INLINE inline
#define WEFT_FLOAT(bits) std::bit_cast<float>(bits)
#define WEFT_BITS(value) std::bit_cast<std::uint32_t>(value)

#else

// Aligned to 4 bytes.
struct packed_uvec2 { uint x, y; };
struct packed_vec3 { float x, y, z; };
struct packed_vec4 { float x, y, z, w; };
uvec2 unpack(packed_uvec2 v) { return uvec2(v.x, v.y); }
vec3 unpack(packed_vec3 v) { return vec3(v.x, v.y, v.z); }
vec4 unpack(packed_vec4 v) { return vec4(v.x, v.y, v.z, v.w); }
packed_vec3 pack(vec3 v) { return packed_vec3(v.x, v.y, v.z); }

// In place of the built-in, whose products and differences a driver may contract, even where it is precise (NVIDIA's does): then parallel
// vectors have a product, and a triangle of no area a normal.
vec3 precise_cross(vec3 a, vec3 b) {
  precise const vec3 product = a.yzx * b.zxy - a.zxy * b.yzx;
  return product;
}
#define cross precise_cross

#define WEFT_ALIGNED
#define WEFT_INLINE
#define WEFT_FLOAT(bits) uintBitsToFloat(bits)
#define WEFT_BITS(value) floatBitsToUint(value)

#define WEFT_DECLARE(number, type, name) layout(constant_id = number) const type name = type(0);
WEFT_CONSTANTS(WEFT_DECLARE)

#define WEFT_BUFFER(access, element, name) \
  layout(set = WEFT_STORAGE_SET, std430) access buffer name##_block { element name[]; };
#define READ(element, name) WEFT_BUFFER(restrict readonly, element, name)
#define WRITE(element, name) WEFT_BUFFER(restrict writeonly, element, name)
#define READ_WRITE(element, name) WEFT_BUFFER(restrict, element, name)
#define SHARE(element, name) WEFT_BUFFER(restrict coherent, element, name)   // workgroups of one dispatch read what others wrote
// A slice of the uniform buffer (Motion, ContactSettings).
#define SLICE(struct_name, name) layout(set = WEFT_STORAGE_SET, std140) uniform name##_slice { struct_name name; };

// A gather reads through texel buffers, which the software driver fetches twice as fast as it loads from storage buffers; that holds for
// the thread's own elements too. On devices that prefer storage buffers, or whose texel buffers are too short, it reads those instead:
// the pass is specialised to one of the two, and the other is not there. GATHER_WRITE is for buffers whose elements a thread fetches and
// then writes itself.
#define WEFT_TEXELS(sampler, name) layout(set = WEFT_TEXEL_SET) uniform sampler name##_texels;
#define GATHER(name) WEFT_TEXELS(samplerBuffer, name) READ(vec4, name)
#define GATHER_UINT4(name) WEFT_TEXELS(usamplerBuffer, name) READ(uvec4, name)
#define GATHER_UINT2(name) WEFT_TEXELS(usamplerBuffer, name) READ(uvec2, name)
#define GATHER_UINT(name) WEFT_TEXELS(usamplerBuffer, name) READ(uint, name)
#define GATHER_WRITE(name) WEFT_TEXELS(samplerBuffer, name) WEFT_BUFFER(, vec4, name)
#define GATHER_WRITE_UINT(name) WEFT_TEXELS(usamplerBuffer, name) WEFT_BUFFER(, uint, name)
// SHARE_GATHER is for buffers that a dispatch gathers from after it has written them: those are storage texel buffers, which are coherent.
#define WEFT_SHARED_TEXELS(image, format, name) layout(set = WEFT_TEXEL_SET, format) restrict coherent uniform image name##_texels;
#define SHARE_GATHER(name) WEFT_SHARED_TEXELS(imageBuffer, rgba32f, name) SHARE(vec4, name)
#define SHARE_GATHER_UINT(name) WEFT_SHARED_TEXELS(uimageBuffer, r32ui, name) SHARE(uint, name)
#define LOAD(name, i) (through_texels ? imageLoad(name##_texels, int(i)) : name[i])
#define LOAD_UINT(name, i) (through_texels ? imageLoad(name##_texels, int(i)).x : name[i])
#define STORE(name, i, value) { if (through_texels) imageStore(name##_texels, int(i), value); else name[i] = value; }
#define STORE_UINT(name, i, value) { if (through_texels) imageStore(name##_texels, int(i), uvec4(value)); else name[i] = value; }
#define FETCH(name, i) (through_texels ? texelFetch(name##_texels, int(i)) : name[i])
#define FETCH_UINT2(name, i) (through_texels ? texelFetch(name##_texels, int(i)).xy : name[i])
#define FETCH_UINT(name, i) (through_texels ? texelFetch(name##_texels, int(i)).x : name[i])

layout(local_size_x_id = 0) in;

#endif

/// Bending stencil: a sum K . p of up to four particles that is zero in every flat pose. Of a hinge the edge (particle[0], particle[1]) and its
/// opposite vertices (Bergou et al. 2006); of a lattice the ends of a line, its middle and what is beside it, or the corners of a quad, those
/// of its diagonal first (engine/effects/bend/lattice.cpp).
struct Bend {
  uint particle[4];
  float k[4];         // K of the stencil: sums to 0
  float compliance;   // 1/(B q) (m^2/N m ... per unit of |l|^2)
  float split_weight; // sum n_j w_j K_j^2 (1/kg)
};

/// Dihedral element, bending about a rest angle (dihedral.comp): the edge (particle[0], particle[1]), its hinge, and the opposite vertices.
struct Hinge {
  uint particle[4];
  float weight[4];    // n_j w_j (1/kg)
  float rest_cosine, rest_sine;   // of the angle at rest, 0 where flat
  float compliance;   // rad^2/J
};

/// Particles that lie together, and the links among them, which one workgroup solves (gauss_seidel.comp).
struct Patch {
  uint first_member, members;   // of patch_members, at most WEFT_PATCH
  uint first_colour, colours;   // of patch_colour_ends: the entry before its first colour's, and how many follow
};
#define WEFT_PATCH 256u
#define WEFT_PATCH_THREADS 64u   // of the workgroup that solves it, at most; a power of two (turn.glsl)

#define WEFT_STRAND_LINKS 16u   // of a strand, at most (strand.comp)
#define WEFT_EAGER_LEVELS 1.4f   // relaxation of coarse levels over that of other passes (level.glsl)
#define WEFT_LEVEL_KEPT 0.98f   // of its length, what an iteration leaves of a coarse link at least where something drives cloth (level.glsl)
#define WEFT_LEVEL_SLACK 0.03f    // Detection::slack where something is pushed
#define WEFT_SLACK_LASTS 30      // substeps, in which it ends after that
#define WEFT_MOST_EAGER 1.75f    // the most that it is
#define WEFT_MOST_EAGER_2 1.2f   // in second order in time, in which a link that only pulls gains energy from 1.3 on
#define WEFT_LEVEL_PART 0.4f   // of what each level alone would change, as levels overlap (implicit/mean.glsl)
#define WEFT_LOW_LEVEL 1024u   // nodes, at most, of a level that one workgroup does

/// One-sided link to an anchor; anchor == WEFT_NONE ends a particle's list. Lists are padded to an even length.
struct Tether {
  uint anchor;        // particle that never moves by itself
  float max_distance; // m
};

#define WEFT_STAYS 0x80000000u       // bits of a pin's particle: it is to stay where it is, wherever that is
#define WEFT_FROM_HERE 0x40000000u   // it begins the frame where it is, and the host does not know where
struct Anchor {
  uint particle;      // WEFT_NONE: a place for a pin, or an anchor that was released
  packed_vec3 from;          // m, at the frame's start
  packed_vec3 to;            // m, at its end
};

/// A particle that a hand pulls to a target (grab.comp).
struct Grab {
  uint particle;      // WEFT_NONE: nobody pulls
  float weight;       // of its iterate while nobody pulls (motion.h)
  float stiffness;    // N/m
  float damping;      // N s/m
  float force;        // N, at most
  packed_vec3 from;          // m, the target at the frame's start
  packed_vec3 to;            // m, at its end
};

/// A pull as it stood when a substep began: what it has given shows where that ends (grab.comp).
struct LastPull {
  uint particle;      // WEFT_NONE: nobody pulled
  float stiffness;    // N/m, and
  float damping;      // N s/m: as much of them as the limited force left
  packed_vec3 place;         // m, of the particle
  packed_vec3 target;        // m, at the substep's end
  packed_vec3 velocity;      // m/s, of the target
  packed_vec3 hand;          // m, where the hand is at the substep's end: the mean of its corners' targets
};

// The buffer holds all planes, then all spheres, capsules and boxes; how many of each is a constant. A particle is put out of them in this
// order, so that where two overlap the later one decides.
struct Collider {
  vec3 centre_from;   // m
  float radius;       // m, spheres and capsules; of one with two radii their mean
  vec3 centre_to;     // m
  float friction;     // Coulomb
  WEFT_ALIGNED vec3 normal_from;     // unit, planes
  WEFT_ALIGNED vec3 normal_to;
  WEFT_ALIGNED vec3 spin;            // rad over the frame, about the centre: where capsules and boxes end follows from it
  WEFT_ALIGNED vec4 rotation_from;   // unit quaternion, capsules and boxes
  vec3 half_size;     // m: half a box's sides; y: half a capsule's length; of one with two radii x where its middle is along its axis,
                      // and z the sine of its taper (collide/round_cone.glsl)
};

/// The size of a collider at the frame's start, where the host may resize it; Collider has that at its end.
struct BodySize {
  float radius;
  packed_vec3 half_size;
};

/// What cloth has given to a collider, or to a hand, since the start, in quanta of 64 bits, two's complement, low and high words apart: an
/// impulse, x y z, and an angular impulse about its centre.
struct Reaction {
  uint low[6], high[6];
};

struct Material {
  float damping_factor;   // of the velocity in a substep: exp(-damping h); in second order 1 / (1 + 2/3 damping h)
  float friction;     // Coulomb
  float thickness;    // m
  float body;         // the number of the cloth, or cloths + that of the mesh collider: a cloth has several materials where maps vary them
};

// State of the Chebyshev guard (chebyshev.glsl), which compares the first iteration's steps of successive substeps. Each array is indexed
// by the phase, the substep modulo 3. `largest` and `reversed` are the bits of squared lengths (m^2).
struct Acceleration {
  uint largest[3];    // of all steps
  uint reversed[3];   // of the steps that point the other way than a substep before
  uint streak[3];     // successive substeps in which `reversed` has grown
  uint cooldown[3];   // further substeps without acceleration
};

struct Counters {
  uint non_finite;    // particles put back to their last finite position
  uint coincident;    // links whose ends were at one place
  uint contacts_most; // candidates that one detection found, at most
  uint contacts_overflowed;   // candidates beyond the capacity, all detections together
  uint truncated;     // times that a step was truncated: by a plane (contact_limit.comp), a displacement bound or an overflowed
                      // candidate, the latter two perhaps several times a substep; kinematic particles only by a plane
  uint detections;
  uint tracking_error;   // bits of a float (m): the largest distance of an anchor from its target at a substep's start
  uint unconverged;   // implicit solves that left more than WEFT_CONVERGED of the residual
  uint stopped;       // implicit solves that broke off with the best there was
  float residual;     // the last implicit solve's, over that of the free flight
  uint unaccelerated; // substeps that fell back from Chebyshev to Jacobi
  uint contacts_load; // of the substep before the last: how much one workgroup would have to do for all contacts, about: ten times the
                      // active ones, and the candidates
  uint crossings_most;   // pairs of an edge and a triangle that it goes through, which one detection found, at most
  uint contacts_room; // the capacity for candidates that every detection so far would have had room in
};

// A solve counts as converged when no more than this is left of its residual, in the norm r . D^-1 r.
#define WEFT_CONVERGED 0.01

/// A cloth, and the velocity that a solve gave to its centre of mass though no spring could.
struct FreeCloth {
  uint first, particles;   // no particles where something holds it
  packed_vec3 drift;              // m/s
};

#define WEFT_GAS_PART 256u     // particles of a part, at least
#define WEFT_GAS_PARTS 1024u   // of all gases, besides the last of each, at most
/// The gas in a closed cloth (pressure.glsl).
struct Gas {
  uint first_part, parts;   // of its cloth
  uint cloth;
  uint particle;            // the cloth's first: places are relative to it
  float volume;             // m^3, > 0: where the scene's amount of it has `pressure`
  float pressure;           // Pa, absolute
  float ambient;            // Pa, outside
  float most;               // m: moves no particle further in a substep
};
/// Particles of a cloth with a gas, which one workgroup goes through.
struct GasPart {
  uint gas;
  uint first;               // of gas_rows
  uint particle;            // that this is of; the others follow
  uint count;
};
/// What a gas found and did in the last substep.
struct GasState {
  float left;               // m^3: the volume that it left to the constraints, as far as its gradient tells
  float gained;             // m^3: by how much it had changed it
};
/// Sums over a part.
struct GasSum {
  float volume;             // m^3, where the substep begins
  float predicted;          // m^3, where it would end
  float mobility;           // m^4/kg: of w |grad V|^2
  float longest;            // m^2/kg: the most of w |grad V|
  GasState before;          // the gas's, for the next pass, which changes it
};

#define WEFT_AIR_EDDIES 16u
#define WEFT_AIR_GUSTS 8u
#define WEFT_AIR_WAVES 24u   // both
/// A part of the air's velocity that is a sine in space and time.
struct AirWave {
  vec3 velocity;      // m/s, at its crest
  float phase;        // rad, at the particles' origin, where the frame begins
  vec3 wave;          // 1/m; 0 for a gust, which is everywhere the same
  float turn;         // rad: by how much the phase changes in the frame
};

#define WEFT_AIR_FIELDS 16u
#define WEFT_AIR_BOX 0u
#define WEFT_AIR_SPHERE 1u
#define WEFT_AIR_JET 2u
#define WEFT_AIR_VORTEX 3u
/// What the air does in a part of space (engine/scene.h, Air::Field).
struct AirField {
  vec3 centre;        // m
  float radius;       // m
  vec3 half_sides;    // m, boxes only
  float falloff;      // m
  vec3 velocity;      // m/s
  uint shape;         // WEFT_AIR_BOX ...
};

#define WEFT_WAKE_LANES 64u   // sums of a body's triangles, side by side (air/air_wake.comp)

/// A particle that a skin moves: where it is at rest, and the joints that carry it (skin.comp).
struct SkinPoint {
  uint particle;
  uint anchor;        // its entry of `anchors`; WEFT_NONE: it is free
  uint cloth;         // whose motion constraints it has; WEFT_NONE: none
  float max_distance; // m
  float stiffness;    // by which the cloth's is multiplied
  float backstop_distance, backstop_radius;   // m; a radius of 0: no backstop
  packed_uvec2 joints;       // four, 16 bits each
  packed_vec4 weights;
  packed_vec3 rest;          // m
  packed_vec3 normal;        // unit, at rest
};

/// By what a morph target moves a point (skin.comp).
struct MorphDelta {
  uint morph;         // of all of the scene
  packed_vec3 position;      // m
};

/// Where the points of a skinned mesh are when a frame begins and when it ends, unless joints say so (host_targets.glsl).
#define WEFT_FROM_KEPT 1u        // it begins where the last frame ended
#define WEFT_TO_KEPT 2u          // it ends where it begins
#define WEFT_TO_HOST 4u          // it ends where the host's buffer has them
#define WEFT_HOST_NORMALS 8u     // which has their normals, too

/// How a cloth's velocities change where its moving frame does not move on evenly: w + m w + n (x - centre) + b (inertia.comp).
struct FrameChange {
  packed_vec3 centre, b;     // m, m/s
  packed_vec3 m[3];          // rows
  packed_vec3 n[3];          // rows, 1/s
};

/// A vertex of a render mesh, bound to a triangle of its cloth (render_mesh.comp).
struct Carried {
  uint corners[3];    // render vertices of the cloth
  uint vertex;        // what it is itself
  float weights[2];   // of the first two corners
  packed_vec3 offset;        // m, in the axes of its place
  packed_vec3 normal;        // unit, in these
};
#define WEFT_PHONG_CURVE 0.5f    // of the way to its corners' tangent planes: the middle of a chord is then on its arc, to the second order

/// A joint's map from the rest pose to the frame's start and end: three rows of an affine matrix each.
struct Joint {
  vec4 from[3];
  vec4 to[3];
};

/// What the host may change of a cloth's motion constraints while running.
struct MotionLimits {
  float scale;        // of all max distances
  float stiffness;    // 0 ... 1
};

/// Where the solve of an implicit substep is (implicit.glsl).
struct Linear {
  float first;        // squared residual r . D^-1 r of the free flight
  float squared;      // squared residual before the last iteration
  float gamma;        // r . z of the last iteration
  float step;         // step length along the search direction
  float next;         // weight of the previous direction in the new one; Jacobi: what its iterate is to be multiplied by
  uint iterate;       // Jacobi: which of the three is the best so far
  uint done;          // 1: nothing more to gain, 2: broken off
  uint arrived;       // workgroups of the dispatch at hand that have summed up; 0 between dispatches
};

/// Arguments of an indirect dispatch.
struct Groups {
  uint x, y, z;
};

/// Triangles that have met a collider in this substep. All 0 between substeps.
struct Collisions {
  Groups groups;      // of triangle_collide
  uint count;
};

#define WEFT_FURTHEST_OUT 0.1f     // m: a triangle moves its corners by no more in an iteration
#define WEFT_WHOLE_DEPTH 0.02f     // m: what moves a corner so far, or further, has the whole weight
#define WEFT_WHOLE_WEIGHT 1024.0f  // as an integer

// Levels of the grid: a box belongs to the first whose cells are at least as long as it, cell * 2^level.
#define WEFT_LEVELS 16

#define WEFT_LONGEST_LIFETIME 10u   // substeps: the longest candidate lifetime
#define WEFT_NO_DISTANCE 4e-7f   // over the extent of a pair's sides: what is nearer has no direction (contact_prepare.comp)
#define WEFT_MOST_TURNS 60000u      // of all loops that a thread of a crew makes: the software driver ends them at 65,535 (Needs::crew)
#define WEFT_WIDE_ROUNDS 2u         // of contact_limit with a thread a pair
#define WEFT_LIMIT_ROUNDS 64u       // of contact_limit in all, at most

// State of contact detection. A detection finds the candidate pairs: those whose sides can come within their separation while every
// particle stays within its displacement bound about its predicted trajectory, a straight one (detect_track.comp says why no contact
// is missed). They serve for several substeps, their lifetime. Group counts are arguments of indirect dispatches, so that the GPU itself
// decides whether there is anything to do.
struct Detection {
  Groups outlined, grid, clusters, particles, faces, edges;   // of the detection's passes; no groups in a substep without a detection
  Groups rare;        // a thread a searcher, where pairs of the search have overflowed or something may have crossed
  Groups near_faces, near_edges;          // a thread a pair that the broad phase found
  Groups searchers, near_pairs;           // the same where detections are seldom: a thread a particle or edge, a row of workgroups each
  Groups prepared;    // a thread a searcher, or where no detection is due a candidate (detect_prepare)
  Groups contacts;    // a thread a candidate
  Groups listed[3];   // a thread an active candidate, an unsafe one, and an active one that penetrates
  Groups touched;     // a thread a particle of an active candidate
  Groups paired;      // a thread a particle, where there are candidates
  Groups alone;       // the one workgroup that does all contacts, where there are candidates
  Groups tangles;     // the one workgroup that untangles, where there are crossings
  uint needs_detection;   // the next substep begins with one
  uint steps;         // substeps since the last detection, at most WEFT_LONGEST_LIFETIME
  uint lifetime;      // substeps that its candidates are meant to serve: the length of trajectories
  uint candidates;    // that it found; those beyond ContactSettings::capacity have overflowed
  float margin, least;   // m: how long displacement bounds may be, and how short
  uint horizon;       // substeps that they are meant to hold for
  float most_pushed;  // m, by how much bounds may be larger where kinematic particles push (predicted_track.glsl)
  uint fastest;       // bits of the longest step of a kinematic particle in this substep (m)
  uint listings[3];   // active candidates of this substep; unsafe ones: those that could cross at its end; active ones that penetrate in this
                      // iteration
  uint touchings;     // particles of active candidates
  uint changed[3];    // 1: this round of contact_limit lowered the step fraction of some particle; of three rounds by turns
  uint falls_back;    // 1: its last round still found a pair that crosses: the fallback fractions apply; WEFT_ALL_WAIT
  uint served, served_lifetime;   // of the detection before: after how many substeps this one came, and its lifetime
  uint settled;       // 1: the last detection came after a full lifetime in which no particle left its displacement bound
  uint near[2];       // pairs that the broad phase found: of particles and triangles, then of edges
  uint may_cross;     // 1: something was driven through cloth: the next detection looks for crossings
  uint looks;         // 1: this one does; 2: and found more tangled pairs than there is room for
  uint crossings;     // pairs of an edge and a triangle that it goes through, which the last detection found; 0 where it did not look
  uint stirs;         // 1: a kinematic particle moves in this substep, or has a trajectory from when it did
  uint stirred;       // substeps in which one did
  float slack;        // of coarse links, over their lengths at rest: where kinematic particles push, and for a while after (level/level.glsl)
  uint levels;        // a bit for each level that has boxes
  uint extents[WEFT_LEVELS];   // bits of the longest half side of a box (m) at each level
};
#define WEFT_ALL_WAIT 2u   // contacts were more than one workgroup can do (contact_alone): no particle of a candidate moves
#define WEFT_ACTIVE 0u
#define WEFT_UNSAFE 1u
#define WEFT_PENETRATING 2u
#define WEFT_PAIRED 0x80000000u  // a bit of a displacement bound, which is not negative: the particle has candidates
#define WEFT_UNTANGLED 1e30f     // m, in place of a candidate's separation: it takes a vertex back through a triangle (untangle.comp)
#define WEFT_SLIDES 4u   // rounds of contact_slide in a substep: what a particle gives way to one pair the next takes into account for others
#define WEFT_CLUSTER 16u         // triangles that detection treats as one until it looks closer, at most
#define WEFT_NEAR_CLUSTERS 63u   // that a cluster's list has room for; with more the search asks all
#define WEFT_MOTION 8u           // elements of cluster_motions a cluster
#define WEFT_MOST_PUSHED 0.3f    // relative to the cell of the grid, which is four and a half edges long: Detection::most_pushed at most
#define WEFT_TOUCHING 0x80000000u   // a bit of its entries: the two share a particle
#define WEFT_NEAR 2u   // capacity for pairs of the broad phase, of each kind, as a multiple of the capacity for candidates

/// What changes from dispatch to dispatch: push constants.
struct Push {
  uint count;         // threads with work
  uint flags;         // WEFT_LAST_ITERATION ...
  float fraction_from, fraction_to;   // of the frame, at this substep's start and end
  uint iteration;     // of an implicit substep's solve; after it, how many there were
  float omega;        // Chebyshev's weight of this iteration (chebyshev/chebyshev.glsl)
  uint first;         // of a pass with ranges: where this dispatch's begins
};

/// Slices of one uniform buffer, written where a frame begins.
struct Motion {
  vec3 gravity;       // m/s^2
  float h;            // s, over which forces and constraints act: a substep, or two thirds of it (bdf2/bdf2.glsl)
  vec3 origin;        // m: what is added to particles' positions for the renderer
  float inverse_h;    // 1/s
  float inverse_h2;   // 1/s^2
  float relaxation;   // over-relaxation of Jacobi and Gauss-Seidel; the weight of the damped Jacobi of the method implicit
  float substep;      // s
  float inverse_substep;   // 1/s
  float level_kept;   // of its length, what an iteration leaves of a coarse link at least (level/level.glsl)
};

struct ContactSettings {
  uint workgroup;     // threads
  uint thin_workgroup;   // threads, in passes with a thread a cluster
  uint particles;
  uint triangles, edges;   // how many; together the primitives
  uint clusters;      // of them: the grid's entries
  uint buckets;       // of the grid, a power of two
  uint capacity;      // candidates
  uint iterations;    // of contacts in an iteration of the solve
  uint tangled_room;  // places for tangled pairs, a power of two
  uint most_turns;    // that a thread of contact_alone may make
  float cell;         // m, at level 0
  float quantum;      // m, unit of contact_sums
  float recover;      // m: how much of a missing separation a substep may recover
  float kinematic_lag_limit;       // the largest tracking error of an anchor, at a substep's start, that cloth may keep, as a multiple
                                   // of its thickness (anchor.comp) or of the pair's separation (contact_limit.comp)
  float margin_low, margin_high;   // m, limits of displacement bounds
};

struct Air {
  vec3 wind;          // m/s
  float half_density; // kg/m^3
  float drag, lift, friction, most;   // coefficients; the largest that a component of the velocity can meet
};

struct CollisionSettings {
  float quantum;      // m, unit of collision_sums and collision_depths: what a particle's triangles ask for fits, each WEFT_FURTHEST_OUT
};

struct ReactionSettings {
  float quanta;       // of an impulse, for each kg m that a collider has moved a particle by: 1 / (h quantum)
};

#define WEFT_LAST_ITERATION 1u   // of the substep: velocities follow
#define WEFT_LAST_SUBSTEP 2u     // of the frame: no further prediction
#define WEFT_FIRST_ITERATION 4u  // of the substep: multipliers start at zero
#define WEFT_ENDS_SUBSTEP 8u     // contact_alone does what contact_finalize does, too
#define WEFT_PASS_SHIFT 8u       // bits 8 to 11: which dispatch of a pass that is repeated (contact_limit)
#define WEFT_PHASE_SHIFT 16u     // bits 16 and 17: the phase, the substep modulo 3

#define WEFT_NONE 0xffffffffu
#define WEFT_MAX_PARTICLES 0x00ffffffu

#ifndef __cplusplus
layout(push_constant, std430) uniform Constants { Push push; };
SLICE(Motion, motion)
SLICE(ContactSettings, contact_settings)
SLICE(CollisionSettings, collision_settings)
SLICE(ReactionSettings, reaction_settings)
SLICE(Air, air)
#endif

#ifdef __cplusplus

static_assert(sizeof(Bend) == 40 && sizeof(Hinge) == 44 && sizeof(Tether) == 8 && sizeof(Patch) == 16 && sizeof(Anchor) == 28);
static_assert(sizeof(Grab) == 44 && sizeof(Collider) == 112 && sizeof(BodySize) == 16);
static_assert(sizeof(SkinPoint) == 76 && sizeof(Joint) == 96 && sizeof(MotionLimits) == 8 && sizeof(Reaction) == 48);
static_assert(sizeof(MorphDelta) == 16 && sizeof(Carried) == 48 && sizeof(FrameChange) == 96);
static_assert(sizeof(Gas) == 32 && sizeof(GasPart) == 16 && sizeof(GasState) == 8 && sizeof(GasSum) == 24);
static_assert(sizeof(Material) == 16 && sizeof(Counters) == 56 && sizeof(Push) == 28 && sizeof(Motion) == 52);
static_assert(sizeof(Linear) == 32 && sizeof(FreeCloth) == 20 && sizeof(Detection) == 420 && sizeof(Acceleration) == 48);
// As std430 and std140 have them.
static_assert(offsetof(Collider, normal_from) == 32 && offsetof(Collider, rotation_from) == 80 && offsetof(Collider, half_size) == 96);
static_assert(offsetof(Motion, origin) == 16 && offsetof(Motion, relaxation) == 36 && offsetof(Air, drag) == 16);
static_assert(std::is_trivially_copyable_v<Push>);

namespace constant {
enum Constant : uint {
#define WEFT_ENUMERATE(number, type, name) name = number,
  WEFT_CONSTANTS(WEFT_ENUMERATE)
#undef WEFT_ENUMERATE
};
#define WEFT_COUNT(number, type, name) + 1
inline constexpr uint kCount = 0 WEFT_CONSTANTS(WEFT_COUNT);
#undef WEFT_COUNT
}  // namespace constant

}  // namespace weft::gpu

#endif

#include "packed.h"

#endif
