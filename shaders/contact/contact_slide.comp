// contact_slide: turns the steps of sides that would cross along the planes that part them (contact_limit.comp), as far as particles can
// move. Jacobi iterations leave something of a penetration, and contact_limit stops a particle for it altogether: cloth under tension was
// held where it should slide, on a mesh collider's corner for ever.
//
// An end below its side's stopping height is raised to it along the normal. A particle takes of all that its pairs ask the largest, of each
// sign of each coordinate: pairs that ask for the same do not add up, and pairs that ask for different things all get them, unless they
// oppose each other. Positive floats are ordered like their bits, so that neither sums nor the order of threads matter.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER_UINT(contact_list)
READ(Detection, detection)
READ_WRITE(uvec4, slides)

#include "contact/contact.glsl"
#include "contact/sides.glsl"

void ask(uint place, vec3 way) {
  if (way.x > 0) atomicMax(slides[place].x, floatBitsToUint(way.x));
  if (way.y > 0) atomicMax(slides[place].y, floatBitsToUint(way.y));
  if (way.z > 0) atomicMax(slides[place].z, floatBitsToUint(way.z));
}

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place >= detection[0].listings[WEFT_ACTIVE]) return;
  const uint i = FETCH_UINT(contact_list, place);
  const vec3 n = FETCH(contact_normals, i).xyz;
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  const Sides sides = sides_of(pair, n);
  const vec4 end = sides.height + sides.displacement;
  const vec2 least = least_of_sides(end, sides.edges);
  if (least.x + least.y >= sides.least_gap) return;
  const vec2 stopping = stopping_heights(sides, end);
  const vec4 missing = (sides.edges ? stopping.xxyy : stopping.xyyy) + 2 * sides.rounding_error - end;
  for (int j = 0; j < 4; ++j) {
    if (sides.kinematic[j] || !(missing[j] > 0)) continue;
    const vec3 way = signs(sides.edges)[j] * missing[j] * n;
    ask(2 * pair.particle[j], way);
    ask(2 * pair.particle[j] + 1, -way);
  }
}
