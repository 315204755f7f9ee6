// triangle_collide: keeps triangles out of spheres, capsules and boxes, so that nothing shows through between vertices and no edge hooks
// on a box's. (A plane that no vertex passes no triangle passes.) Vertices are kept out after it, where the iteration ends (collide.glsl).
//
// A thread is a triangle that triangle_search has listed. One that is nearer to a body than its separation is put out along the normal n
// of its gap by its nearest point, c = sum b_j p_j: C = n . c - size >= 0 has the gradients b_j n, so corner j moves by b_j / (sum b^2) of
// what is missing (Mueller et al. 2007; as for equal masses, so that an anchor beside it does not fling a particle away). finalize.glsl
// moves a particle by the mean over its triangles, weighted by the square of how far each moves it (with plain means, where one triangle
// of six carries the load, edges stayed 1 mm deep in a box), and by more where they move it in unlike directions, for which it is told how
// far they do. The sums are integers, so that the order of threads does not matter.
//
// The way out is the shortest, unless it leads to the other side of the body than where the triangle was when the substep began: then the
// triangle goes back there, so that a fast body does not pass between vertices. A triangle with an anchor inside the body cannot be put
// out and is left alone.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
GATHER(positions)
GATHER(velocities)
GATHER(materials)
GATHER_UINT4(triangles)
GATHER(supports)
READ(Collisions, collisions)
READ(uint, collision_list)
READ_WRITE(ivec4, collision_sums)
READ_WRITE(int, collision_depths)

#include "triangle/bodies.glsl"
#include "triangle/gap.glsl"
#include "support/support.glsl"

// What is inside comes out at once; of what a gap is then still short, so much is made up for in a substep. All at once it would turn into
// speed, and cloth that lies over an edge would shiver, at 6 cm/s. Of a box that grows all: what is left over adds up, substep after substep.
const float kRecovered = 0.5;

// Where the triangle is (b), seen from the side on which it was (a), and the gap that is wanted: none that overlaps, and `recovered` of the rest.
Gap gap_from_its_side(Body body, mat3 a, mat3 b, float separation, float recovered, out float wanted) {
  const Gap now = gap_of(body, b);
  Gap before = gap_of(body, a);
  wanted = min(separation, mix(max(before.size, 0), separation, recovered));
  before.size = dot(before.normal, point_at(b, before.weights)) - support_of(body, before.normal);
  return dot(now.normal, before.normal) >= 0 ? now : before;
}

float squared(float x) { return x * x; }

// In quanta, what is `weight` of the whole.
int quanta_of(float weight, float length) { return int(round(weight / collision_settings.quantum * length)); }

// Adds to one half of a particle's sums (m, in the world's axes).
void add(uint half_of, vec3 correction, float weight) {
  const float too_far = max(length(correction) / WEFT_FURTHEST_OUT, 1);
  const ivec3 quanta = ivec3(round(weight / (too_far * collision_settings.quantum) * correction));
  atomicAdd(collision_sums[half_of].x, quanta.x);
  atomicAdd(collision_sums[half_of].y, quanta.y);
  atomicAdd(collision_sums[half_of].z, quanta.z);
}

// Moves a corner out. In the body's axes what is carried along does not move, and Coulomb friction is as in collide.glsl. Of a body that
// changes its size the mean is enough: made longer, it threw cloth off a box's corners at four times their speed.
void correct(Body body, bool is_resized, uint particle, vec3 a, vec3 b, vec3 normal, float missing) {
  const float depth = min(missing, WEFT_FURTHEST_OUT);
  const float weight = ceil(WEFT_WHOLE_WEIGHT * min(squared(depth / WEFT_WHOLE_DEPTH), 1));
  const vec3 motion = b - a, slip = motion - dot(motion, normal) * normal;
  const float len = length(slip);
  const vec3 outwards = rotate(body.pose.rotation_to, normal);
  add(2 * particle, depth * outwards, weight / WEFT_WHOLE_WEIGHT);
  const float pressed = has_supports ? max(depth + dot(held_by(FETCH(supports, particle)), outwards), 0) : depth;
  const vec3 rubbed = -min(1, body.friction * pressed / max(len, 1e-12)) * slip;
  add(2 * particle + 1, rotate(body.pose.rotation_to, rubbed), weight / WEFT_WHOLE_WEIGHT);
  atomicAdd(collision_sums[2 * particle].w, int(weight));
  if (!is_resized) atomicAdd(collision_depths[particle], quanta_of(weight / WEFT_WHOLE_WEIGHT, depth));
  if (reacts) atomicMax(collision_sums[2 * particle + 1].w, int(body.number));
}

bool is_held_inside(Body body, bool is_anchor, vec3 p, float separation) { return is_anchor && distance_to(body, p) < separation; }

void collide(Body body, uvec3 corner, mat3 x, mat3 p, bvec3 is_anchor, float separation) {
  mat3 a = mat3(at_start(body.pose, x[0]), at_start(body.pose, x[1]), at_start(body.pose, x[2]));
  const bool is_resized = changes_size(planes + body.number - 1, push.fraction_from, push.fraction_to);
  if (resizes && body.radius == 0) {   // as in out_of_box
    const vec3 growth = growth_of(planes + body.number - 1, push.fraction_from, push.fraction_to);
    a = mat3(growth * a[0], growth * a[1], growth * a[2]);
  }
  const mat3 b = mat3(at_end(body.pose, p[0]), at_end(body.pose, p[1]), at_end(body.pose, p[2]));
  for (int k = 0; k < 3; ++k)
    if (is_held_inside(body, is_anchor[k], b[k], separation)) return;
  float wanted;
  const Gap gap = gap_from_its_side(body, a, b, separation, body.radius == 0 && is_resized ? 1 : kRecovered, wanted);
  const float missing = wanted - gap.size;
  if (!(missing > 0 && missing < 1e10)) return;
  const vec3 share = gap.weights / dot(gap.weights, gap.weights);
  for (int k = 0; k < 3; ++k)
    if (gap.weights[k] > 0 && !is_anchor[k]) correct(body, is_resized, corner[k], a[k], b[k], gap.normal, missing * share[k]);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= collisions[0].count) return;
  const uvec3 corner = FETCH(triangles, collision_list[i]).xyz;
  const vec4 material = material_of_triangle(corner);
  const mat3 x = mat3(FETCH(positions, corner.x).xyz, FETCH(positions, corner.y).xyz, FETCH(positions, corner.z).xyz);
  const vec4 p = FETCH(predicted, corner.x), q = FETCH(predicted, corner.y), r = FETCH(predicted, corner.z);
  for (uint k = first_body; k < last_body; ++k)
    if (meets_body(material, planes + k))
      collide(body_at(k, particle_of(material)), corner, x, mat3(p.xyz, q.xyz, r.xyz), equal(vec3(p.w, q.w, r.w), vec3(0)),
              separation_of(material));
}
