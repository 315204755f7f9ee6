// Contacts: cloth against cloth, itself included, and against mesh colliders.
#pragma once

#include <bit>

#include "engine/effects/contact/clusters.h"
#include "engine/effects/surface/surface.h"

namespace weft {

/// Settings of the contact passes: the scene's, with defaults from the mean edge length and the thickness where the scene
/// says 0. All 0 without contacts.
gpu::ContactSettings contact_settings(const Scene& scene, const CookedFabric& fabric);

namespace lengths {
inline std::uint64_t edges(const Cooked& s) { return s.fabric.own.of<ClusterLists>().edges.size(); }
inline std::uint64_t primitives(const Cooked& s) { return triangles(s) + edges(s); }
inline std::uint64_t clusters(const Cooked& s) { return s.contacts.clusters; }
inline std::uint64_t outlined(const Cooked& s) { return particles(s) + primitives(s) + clusters(s); }
inline std::uint64_t buckets(const Cooked& s) { return s.contacts.buckets; }
}  // namespace lengths

/// Who meets whom, where it is not all: rows of bits, for each cloth and then each mesh collider (contact/mask.glsl).
struct ContactMasks {
  std::vector<gpu::uint> words;
  gpu::uint stride = 0;   // words in a row; 0: all meet
};

namespace buffers {

inline constexpr Buffer contact_masks = own<gpu::uint, &ContactMasks::words>("contact_masks");

// ---- cooked

inline constexpr Buffer clusters = own<gpu::uvec4, &ClusterLists::clusters>("clusters");
inline constexpr Buffer cluster_faces = own<gpu::uvec4, &ClusterLists::faces>("cluster_faces");
/// Edges of all triangles, each once.
inline constexpr Buffer cluster_edges = own<gpu::uvec4, &ClusterLists::edges>("cluster_edges");
inline constexpr Buffer cluster_searchers = own<gpu::uvec2, &ClusterLists::searchers>("cluster_searchers");
inline constexpr Buffer cluster_hulls = own<gpu::uint, &ClusterLists::hulls>("cluster_hulls");
inline constexpr Buffer memberships = own<gpu::uint, &ClusterLists::memberships>("memberships");
inline constexpr Buffer cluster_surroundings = own<gpu::uvec4, &ClusterLists::surroundings>("cluster_surroundings");
inline constexpr Buffer clusters_around = own<gpu::uint, &ClusterLists::around>("clusters_around");
/// xyz rest position (m), w thickness (m).
inline constexpr Buffer rest = cooked<gpu::vec4, &CookedFabric::rest>("rest");

// ---- detection: valid from one detection to the next

/// State of contact detection.
inline constexpr Buffer detection = [] {
  Buffer row = buffer<gpu::Detection>("detection", Lifetime::persistent, lengths::one, [](const Cooked& s) {
    std::vector<gpu::Detection> detection(1);
    detection[0].needs_detection = 1;
    detection[0].may_cross = s.scene.contacts.untangle;
    return made(detection);
  });
  row.access = Access::arguments;
  return row;
}();
/// xyz position at the last detection (m), w the displacement bound that the particle's own motion asked for (m).
inline constexpr Buffer detected_positions = buffer<gpu::vec4>("detected_positions", Lifetime::persistent, lengths::particles);
/// xyz predicted trajectory from there: the displacement in Detection::lifetime substeps (m), w the displacement bound that detection
/// reckoned with (m).
inline constexpr Buffer trajectories = buffer<gpu::vec4>("trajectories", Lifetime::persistent, lengths::particles);
/// Displacement bound: how far the particle may be from its predicted trajectory (m, bits of a float); 0: a candidate of it has
/// overflowed, and it stays where it is. WEFT_PAIRED, in place of the sign: it has candidates.
inline constexpr Buffer displacement_bounds = buffer<gpu::uint>("displacement_bounds", Lifetime::persistent, lengths::particles);
/// The largest bound that the motion of a particle of its cluster asked for at the last detection (m, bits of a float).
inline constexpr Buffer near_bounds = buffer<gpu::uint>("near_bounds", Lifetime::persistent, lengths::particles);
/// Candidate pairs: those that could touch before the next detection (pack_candidate).
inline constexpr Buffer candidates = growing(buffer<gpu::uvec4>("candidates", Lifetime::persistent, lengths::candidates));

// ---- the grid

/// Number of entries of each bucket.
inline constexpr Buffer grid_counts = cleared<gpu::uint>("grid_counts", lengths::buckets);
/// First entry of each bucket, and the end of the last bucket.
inline constexpr Buffer grid_starts = scratch<gpu::uint>("grid_starts", [](const Cooked& s) { return lengths::buckets(s) + 1; });
/// xyz middle of a cluster's box (m), w bits of level << 28 | its number.
inline constexpr Buffer grid_entries = scratch<gpu::vec4>("grid_entries", lengths::clusters);
/// Two a cluster: xyz of its box's corners (m).
inline constexpr Buffer cluster_boxes = scratch<gpu::vec4>("cluster_boxes", [](const Cooked& s) { return 2 * lengths::clusters(s); });
/// By how much the bounds of the particles in a cluster's hull exceed their own, because kinematic particles push it (m, bits of a float).
inline constexpr Buffer cluster_pushes = scratch<gpu::uint>("cluster_pushes", lengths::clusters);
/// Eight a cluster (cluster_box.comp): columns of the mean deformation gradient at the detection, w how far a triangle's is from it, the
/// largest gradient of a barycentric coordinate at rest (1/m), how far a particle may be from its trajectory (m); columns of the gradient
/// where trajectories end; xyz its trajectory, w how far a particle's is from it (m); how far a gradient is off across it, 1 if one of its
/// particles is kinematic.
inline constexpr Buffer cluster_motions =
    scratch<gpu::vec4>("cluster_motions", [](const Cooked& s) { return WEFT_MOTION * lengths::clusters(s); });
/// 1: no two places of the cluster and those that it touches can meet, but neighbours (smooth.glsl).
inline constexpr Buffer smooth_clusters = scratch<gpu::uint>("smooth_clusters", lengths::clusters);
/// WEFT_NEAR_CLUSTERS + 1 a cluster: how many clusters' boxes overlap its own, and which (WEFT_TOUCHING marks some);
/// then those that it may meet (near_list.glsl).
inline constexpr Buffer near_clusters =
    scratch<gpu::uint>("near_clusters", [](const Cooked& s) { return (WEFT_NEAR_CLUSTERS + 1) * lengths::clusters(s); });
/// (WEFT_NEAR_CLUSTERS + 1) / 2 a cluster: the boxes of those, two each, in grains of its own (near_list.glsl).
inline constexpr Buffer near_boxes =
    scratch<gpu::uvec4>("near_boxes", [](const Cooked& s) { return (WEFT_NEAR_CLUSTERS + 1) / 2 * lengths::clusters(s); });
/// Three a primitive, triangles first: its Outline (outline.glsl): xyz middle, w reach; xyz half sides; xyz trajectory (m).
inline constexpr Buffer outlines = scratch<gpu::vec4>("outlines", [](const Cooked& s) { return 3 * lengths::primitives(s); });
/// One for two primitives: the corners of their outlines' boxes in grains of their clusters' boxes (outline_box.glsl).
inline constexpr Buffer outline_boxes =
    scratch<gpu::uvec4>("outline_boxes", [](const Cooked& s) { return (lengths::primitives(s) + 1) / 2; });

// ---- contacts

/// xyz unit normal from side B to side A. w (m), of an active candidate: the separation it must have, above 0; of any other:
/// minus the height of its first particle over the middle of the gap.
inline constexpr Buffer contact_normals = growing(scratch<gpu::vec4>("contact_normals", lengths::candidates));
/// Barycentric weights of the closest points: side A's positive, side B's negative; but for the first one (contact.glsl).
inline constexpr Buffer contact_weights = growing(scratch<gpu::vec4>("contact_weights", lengths::candidates));
/// Pairs that the broad phase found: of two edges; of a particle and a triangle. Their capacity is WEFT_NEAR times that for
/// candidates. They share memory with the contacts, which are prepared later.
inline constexpr Buffer near_edges = [] {
  Buffer row = growing(scratch<gpu::uvec2>("near_edges", [](const Cooked& s) { return WEFT_NEAR * lengths::candidates(s); }));
  row.lies_in = &contact_normals;
  return row;
}();
inline constexpr Buffer near_faces = [] {
  Buffer row = growing(scratch<gpu::uvec2>("near_faces", [](const Cooked& s) { return WEFT_NEAR * lengths::candidates(s); }));
  row.lies_in = &contact_weights;
  return row;
}();
/// Numbers of the active candidates, at the substep's end those of the unsafe ones; then of those that penetrate (contact_list.glsl).
inline constexpr Buffer contact_list =
    growing(scratch<gpu::uint>("contact_list", [](const Cooked& s) { return 2 * lengths::candidates(s); }));
/// Particles of active candidates that are not kinematic.
inline constexpr Buffer touched_particles = scratch<gpu::uint>("touched_particles", lengths::particles);
/// Number of active contacts of each particle in this substep; 0 for kinematic ones.
inline constexpr Buffer contact_counts = cleared<gpu::uint>("contact_counts", lengths::particles);
/// xyz sum of a particle's corrections in units of ContactSettings::quantum, between iterations what rounding of its place has left of them;
/// w with reactions the mesh collider that it has touched in the substep, counted from 1. All 0 between substeps.
inline constexpr Buffer contact_sums = cleared<gpu::ivec4>("contact_sums", lengths::particles);
/// Sum of the penetrations of a particle's contacts, each times its weight (contact_share.glsl); 0 between iterations.
inline constexpr Buffer contact_penetrations = cleared<gpu::uint>("contact_penetrations", lengths::particles);
/// Two a particle: xyz the largest way that contact_slide asks for along each coordinate, upwards and downwards (m, bits of floats); 0
/// between its rounds. w the rank that a round gives it, and the one that it has (contact.glsl); 0 between substeps.
inline constexpr Buffer slides = cleared<gpu::uvec4>("slides", [](const Cooked& s) { return 2 * lengths::particles(s); });
/// How far a kinematic particle was behind its target when the substep began (m, bits of a float; anchor.comp); 0 for all others.
inline constexpr Buffer kinematic_lags = buffer<gpu::uint>("kinematic_lags", Lifetime::persistent, lengths::particles);
/// Step fractions (times of impact): the part of its step that a particle may take, bits of a float (limit.glsl has the
/// entries).
inline constexpr Buffer step_fractions = cleared<gpu::uvec4>("step_fractions", lengths::particles, std::bit_cast<std::uint32_t>(1.0f));

}  // namespace buffers
}  // namespace weft
