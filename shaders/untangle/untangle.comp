// untangle: takes cloth back that goes through cloth. Runs where the detection has found crossings, in one workgroup.
//
// Regions. Where surfaces go through each other they meet along contours. An edge with an odd number of crossings leads from one side of
// a contour to the other, so contours cut a mesh into regions, the components of what hangs together by all other edges: the corner that
// was poked through a sheet and the rest of its own, a sleeve's end and the shirt. Of two regions the smaller is on the wrong side (after
// the global intersection analysis of Baraff, Witkin and Kass 2003, "Untangling cloth"; here it does not matter where contours end).
//
// Steps. A contour is undone edge by edge: of an edge that leads from one region to another, the end in the smaller one is taken back
// through the triangle that is the first in its way. That is a contact (contact_solve.comp) whose normal points to the other end's side.
// What lies behind it keeps to its side, as contacts have it, until the contour arrives there. A contour that cuts nothing off begins at
// one rim and ends at another: there the rims go along it, and it grows shorter (Volino and Magnenat-Thalmann 2006, "Resolving surface
// collisions through intersection contour minimization", of whose gradient this is what does not cancel between two triangles).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(rest)
GATHER_UINT4(cluster_edges)
GATHER_UINT4(cluster_faces)
GATHER_UINT2(crossed_triangles)
WRITE(vec4, contact_normals)
WRITE(vec4, contact_weights)
// This dispatch has written what it reads of these.
SHARE(uint, regions)
SHARE(uint, region_sizes)
SHARE(Detection, detection)

WRITE(uvec4, candidates)
GATHER_WRITE_UINT(displacement_bounds)
READ_WRITE(Counters, counters)
#include "contact/candidate.glsl"
WRITE(uint, contact_list)
#include "contact/list_places.glsl"
#include "contact/contact_list.glsl"
#include "contact/count.glsl"
#include "contact/proximity.glsl"

// Relative to the speed at which contacts recover their separation.
const float kEager = 4;

shared uint ended_early;

#include "wait.glsl"

bool is_cut(uint edge) { return FETCH_UINT2(crossed_triangles, edge).y >> 31 != 0; }

// Where `particle` hangs: the least number known of its region. Paths are halved on the way.
uint root_of(uint particle, inout uint left) {
  uint above = regions[particle];
  while (above != particle && left != 0) {
    const uint next = regions[above];
    if (next != above) regions[particle] = next;
    particle = above;
    above = next;
    --left;
  }
  return particle;
}

void join(uint a, uint b, inout uint left) {
  for (; left != 0; --left) {
    a = root_of(a, left);
    b = root_of(b, left);
    if (a == b || atomicCompSwap(regions[max(a, b)], max(a, b), min(a, b)) == max(a, b)) return;
  }
}

// Every particle's region: the least number of a particle that it hangs together with. Union and find without locks (Jayanti and Tarjan
// 2016): a root is only ever hung below a lesser one, so where it ends does not depend on the order of threads. Whether there were turns
// enough (WEFT_MOST_TURNS).
bool find_regions(uint thread) {
  const uint particles = contact_settings.particles, edges = contact_settings.edges;
  uint left = WEFT_MOST_TURNS - min(WEFT_MOST_TURNS, 4 * (particles + edges) / workgroup);
  if (thread == 0) ended_early = 0;
  for (uint i = thread; i < particles; i += workgroup) {
    regions[i] = i;
    region_sizes[i] = 0;
  }
  wait();
  for (uint edge = thread; edge < edges; edge += workgroup)
    if (!is_cut(edge)) join(FETCH(cluster_edges, edge).x, FETCH(cluster_edges, edge).y, left);
  wait();
  for (uint i = thread; i < particles; i += workgroup) regions[i] = root_of(i, left);
  if (left == 0) ended_early = 1;
  wait();
  for (uint i = thread; i < particles; i += workgroup) atomicAdd(region_sizes[regions[i]], 1u);
  wait();
  return ended_early == 0;
}

// A contact that moves `vertex` along n against the triangle t. x: their places relative to the vertex.
void ask(uint vertex, uvec3 t, vec3 n, mat4x3 x) {
  const uvec4 particle = uvec4(vertex, t);
  const vec4 inverse_masses =
      vec4(FETCH(positions, vertex).w, FETCH(positions, t.x).w, FETCH(positions, t.y).w, FETCH(positions, t.z).w);
  if (inverse_masses == vec4(0)) return;
  const vec4 weights = closest_to_triangle(x[0], x[1], x[2], x[3]);
  const uint index = add_candidate(particle, WEFT_UNTANGLED, false);
  if (index == WEFT_NONE) return;
  contact_normals[index] = vec4(n, dot(n, x * weights) + kEager * contact_settings.recover);
  contact_weights[index] = weights;
  list(WEFT_ACTIVE, index);
  for (uint k = 0; k < 4; ++k) count(particle[k]);
  detection[0].needs_detection = 1;
}

mat4x3 relative(uint vertex, uvec3 t) {
  const vec3 origin = FETCH(positions, vertex).xyz;
  return mat4x3(vec3(0), FETCH(positions, t.x).xyz - origin, FETCH(positions, t.y).xyz - origin, FETCH(positions, t.z).xyz - origin);
}

vec3 unit(vec3 v) { return dot(v, v) > 0 ? v / length(v) : vec3(0); }

// Takes the end `wrong` of an edge back through the triangle, to the side of the end `right`.
void take_back(uint wrong, uint right, uint face) {
  const uvec3 t = FETCH(cluster_faces, face).xyz;
  const mat4x3 x = relative(wrong, t);
  const vec3 n = unit(cross(x[2] - x[1], x[3] - x[1]));
  const float side = dot(n, FETCH(positions, right).xyz - FETCH(positions, wrong).xyz);
  if (side != 0) ask(wrong, t, side > 0 ? n : -n, x);
}

// The edge of a rim, `inner` being the third particle of its triangle, goes along the contour that begins there.
void draw_in(uvec2 ends, uint inner, uint face) {
  const uvec3 t = FETCH(cluster_faces, face).xyz;
  const mat4x3 x = relative(ends.x, t);
  const vec3 origin = FETCH(positions, ends.x).xyz;
  const vec3 edge = FETCH(positions, ends.y).xyz - origin, inwards = FETCH(positions, inner).xyz - origin;
  const vec3 along = unit(cross(cross(edge, inwards), cross(x[2] - x[1], x[3] - x[1])));
  const vec3 across = inwards - dot(inwards, edge) / max(dot(edge, edge), 1e-30) * edge;
  const float side = dot(along, across);
  if (side != 0) ask(ends.x, t, side > 0 ? along : -along, x);
}

void undo(uint edge) {
  const uvec2 through = FETCH_UINT2(crossed_triangles, edge);
  if (through.x == WEFT_NONE) return;
  const uvec4 e = FETCH(cluster_edges, edge);
  const uint a = regions[e.x], b = regions[e.y];
  if (a != b && is_cut(edge)) {
    const uint size_a = region_sizes[a], size_b = region_sizes[b];
    const bool a_is_wrong = size_a != size_b ? size_a < size_b : a > b;
    if (a_is_wrong) take_back(e.x, e.y, through.x);
    else take_back(e.y, e.x, through.y & 0x7fffffffu);
  } else if (e.w != 0) {
    draw_in(e.xy, e.w - 1, through.x);
  }
}

void main() {
  const uint thread = gl_LocalInvocationID.x;
  if (thread == 0) counters[0].crossings_most = max(counters[0].crossings_most, detection[0].crossings);
  if (!find_regions(thread)) return;
  for (uint edge = thread; edge < contact_settings.edges; edge += workgroup) undo(edge);
}
