// motion_constraint: keeps a particle in front of its backstop and within the max distance of its animated place (Scene's
// MotionConstraints has the figure). Both move evenly through the frame, so no substep sees a jump. The max distance comes last: towards the
// animated place, which lies in front of its backstop, nothing leads far into that. Needs push.

GATHER(motion_targets)

vec3 within_motion_constraint(uint i, vec3 p) {
  const vec4 from = FETCH(motion_targets, 4 * i), to = FETCH(motion_targets, 4 * i + 1);
  const float max_distance = from.w, stiffness = to.w, fraction = push.fraction_to;
  if (motion_constraints > 1) {
    const vec4 stop = FETCH(motion_targets, 4 * i + 2);
    const vec3 centre = stop.xyz + fraction * (FETCH(motion_targets, 4 * i + 3).xyz - stop.xyz), out_of = p - centre;
    const float squared = dot(out_of, out_of);
    if (squared < stop.w * stop.w && squared > 0) p += (stop.w / sqrt(squared) - 1) * out_of;
  }
  const vec3 off = p - (from.xyz + fraction * (to.xyz - from.xyz));
  const float squared = dot(off, off);
  return squared > max_distance * max_distance ? p + stiffness * (max_distance / sqrt(squared) - 1) * off : p;
}
