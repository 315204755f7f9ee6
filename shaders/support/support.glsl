// support: what colliders hold. A solve that knows nothing of colliders pulls cloth into them, and they put it out again; so they give
// it, in a substep, what the particles on them weigh, and not what hangs on these. On a capsule's end a few carried a sheet, and stood at
// twelve times their distance, the farther the finer the cloth was.
//
// So what colliders have put out by d along n in the last substeps is heavier against them in this one's solve: of its inverse mass w is
// left
//     W = w (I - d / (d + kHardly) n n^T),
// which where d is long is a constraint's of Baraff and Witkin (1998, "Large steps in cloth simulation": mass modification). So are the
// nodes of coarse levels that carry it, by the mean of d n over what they carry. A support is one vector s: W = w (I - s s^T).
//
// What is held is what colliders would have corrected, so friction counts it as depth, and with reactions the collider that has put the
// particle out last is told its momentum. A node's would act at the node's centre, beside the particles: with reactions these alone are held.

const bool nodes_are_held = has_supports && !reacts;

// m. What is put out by as little is hardly held, so that cloth at rest, which gravity moves by a few hundredths of a millimetre in a
// substep, comes off without a tug.
const float kHardly = 5e-5;

// Of a support, what an iteration renews, and what a substep leaves where no collider has met the particle: what held cloth in one substep
// and not in the next made it shiver on the corners of boxes, at a metre a second.
const float kRenewed = 0.15, kKept = 0.5;

// The cosine up to which a support turns at once with the collider's normal. What slides over a thin rod turns by a few degrees in a
// substep; held along where it had come from it was dragged, and fell off after 3 s instead of 0.8. Over a box's edges normals leap, and
// only their mean is quiet.
const float kTurnsAtOnce = 0.98;

// m. More would hold no better, and would be let go too late: fast bodies passed between particles that were still held by where they had
// been.
const float kMost = 0.002;

// m, of `put_out`: less has no direction, and is nothing.
const float kNothing = 1e-9;

// What was held (m), with its direction: support.xyz is what has been put out, support.w how much was held.
vec3 held_by(vec4 support) {
  const float d = length(support.xyz);
  return d > kNothing ? support.w / d * support.xyz : vec3(0);
}

// What holds a particle in the next substep: by how far colliders have put it out, and what was held besides, as what is held is not put
// out. What was pulled off them, and has not met one since, is let go. So is what is not finite. `ends`: the substep does.
vec3 renewed(vec4 support, vec3 put_out, bool ends) {
  vec3 next = ends ? (support.w < 0 ? 0 : kKept) * support.xyz : support.xyz;
  if (put_out != vec3(0)) {
    const float depth = length(put_out), before = length(support.xyz);
    const vec3 n = put_out / depth;
    const float along = dot(support.xyz, n);
    const float now = min(depth + max(support.w, 0) * max(along, 0) / max(before, kNothing), kMost);
    next = along > kTurnsAtOnce * before ? mix(before, now, kRenewed) * n : mix(support.xyz, now * n, kRenewed);
  }
  return length(next) > kNothing && length(next) < 1 ? next : vec3(0);
}

vec3 support_from(vec3 put_out) {
  const float d = length(put_out);
  return d > kNothing ? inversesqrt(d * (d + kHardly)) * put_out : vec3(0);
}

// What a support leaves of a step, or of an impulse.
vec3 yields(vec3 support, vec3 step) { return step - dot(support, step) * support; }

// Of the inverse mass, what a support takes along the unit u.
float heaviness_along(vec3 support, vec3 u) {
  const float along = dot(support, u);
  return along * along;
}

// Of a link's inverse mass, supports take at most so much. Where both ends are held almost along it, as on two sides of a plate, it could
// only shorten by their slipping far aside.
const float kMostTaken = 0.75;

// m, the depth of what is held of a step into the collider.
float held_of(vec3 support, vec3 step) { return -dot(support, step) * length(support); }
