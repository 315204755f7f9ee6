// skin: where morph targets and joints carry particles, at the frame's start and at its end. First each morph target moves a point by its
// delta, times its weight. Then, by linear blend skinning, the point goes where the mean of its joints' maps, by its weights, takes it
// (Magnenat-Thalmann, Laperriere, Thalmann 1988). An anchor, or a corner of a mesh collider, gets it as its
// target; a free particle as its animated place, with the centre of its backstop (motion_constraint.glsl).
//
// A frame begins to the bit where the one before has ended, since both are made from the same weights and joints by the same sums. A host
// that does all this itself says in a buffer where they are (host_targets.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ(SkinPoint, skin_points)
READ(Joint, skin_joints)
READ(MotionLimits, motion_limits)
READ(uvec2, morph_rows)
READ(MorphDelta, morph_deltas)
READ(packed_vec3, morph_normals)
READ(vec2, morph_weights)
WRITE(Anchor, anchors)
WRITE(vec4, motion_targets)
#include "skin/host_targets.glsl"

struct Shape {
  vec3 x, normal;   // of a point, before joints carry it
};

// Where morph targets have the k-th point when the frame begins and when it ends.
void morph(uint k, inout Shape from, inout Shape to) {
  const uvec2 row = morph_rows[k];
  for (uint at = row.x; at < row.x + row.y; ++at) {
    const MorphDelta delta = morph_deltas[at];
    const vec2 w = morph_weights[delta.morph];
    const vec3 position = unpack(delta.position);
    precise const vec3 x_from = from.x + w.x * position, x_to = to.x + w.y * position;
    from.x = x_from;
    to.x = x_to;
    if (morphs < 2) continue;
    const vec3 normal = unpack(morph_normals[at]);
    precise const vec3 n_from = from.normal + w.x * normal, n_to = to.normal + w.y * normal;
    from.normal = n_from;
    to.normal = n_to;
  }
}

struct Blend {
  vec4 row[3];   // of an affine matrix
};

vec3 applied(Blend m, vec4 x) {
  precise vec3 y = vec3(dot(m.row[0], x), dot(m.row[1], x), dot(m.row[2], x));
  return y;
}

#define BLENDED(row) \
  w.x * skin_joints[joint.x].row + w.y * skin_joints[joint.y].row + w.z * skin_joints[joint.z].row + w.w * skin_joints[joint.w].row

Blend blend_from(uvec4 joint, vec4 w) {
  precise Blend blend = Blend(vec4[](BLENDED(from[0]), BLENDED(from[1]), BLENDED(from[2])));
  return blend;
}

Blend blend_to(uvec4 joint, vec4 w) {
  precise Blend blend = Blend(vec4[](BLENDED(to[0]), BLENDED(to[1]), BLENDED(to[2])));
  return blend;
}

// The normal turns with the surface (not quite where joints scale by directions). Without a length: up.
vec3 turned(Blend m, vec3 normal) {
  const vec3 n = applied(m, vec4(normal, 0));
  const float size = length(n);
  return size > 1e-12 ? n / size : vec3(0, 1, 0);
}

void constrain(SkinPoint point, Ends ends) {
  const MotionLimits limits = motion_limits[point.cloth];
  const uint at = 4 * point.particle;
  motion_targets[at] = vec4(ends.x_from, limits.scale * point.max_distance);
  motion_targets[at + 1] = vec4(ends.x_to, limits.stiffness * point.stiffness);
  if (motion_constraints < 2) return;
  const float behind = point.backstop_distance + point.backstop_radius;
  motion_targets[at + 2] = vec4(ends.x_from - behind * ends.normal_from, point.backstop_radius);
  motion_targets[at + 3] = vec4(ends.x_to - behind * ends.normal_to, 0);
}

void main() {
  const uint k = gl_GlobalInvocationID.x;
  if (k >= push.count) return;
  const SkinPoint point = skin_points[k];
  const uvec4 joint = uvec4(point.joints.x & 0xffffu, point.joints.x >> 16, point.joints.y & 0xffffu, point.joints.y >> 16);
  const vec4 weights = unpack(point.weights);
  const Blend from = blend_from(joint, weights), to = blend_to(joint, weights);
  Shape start = Shape(unpack(point.rest), unpack(point.normal)), end = start;
  if (morphs > 0) morph(k, start, end);
  Ends ends;
  ends.x_from = applied(from, vec4(start.x, 1));
  ends.x_to = applied(to, vec4(end.x, 1));
  if (motion_constraints > 1) {
    ends.normal_from = turned(from, start.normal);
    ends.normal_to = turned(to, end.normal);
  }
  if (takes_targets) ends = with_host_targets(k, ends);
  if (skins_move_anchors && point.anchor != WEFT_NONE) {   // whether it is held is the host's business
    anchors[point.anchor].from = pack(ends.x_from);
    anchors[point.anchor].to = pack(ends.x_to);
  }
  if (motion_constraints > 0 && point.cloth != WEFT_NONE) constrain(point, ends);
}
