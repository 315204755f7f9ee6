// size: how large a collider is, where the host may resize it: it grows and shrinks evenly through a frame. Needs collide.glsl.

READ(Collider, colliders)
READ(BodySize, body_sizes)

// As large as it is at that fraction of the frame.
Collider collider_at(uint k, float fraction) {
  Collider c = colliders[k];
  if (resizes) {
    c.radius = body_sizes[k].radius + fraction * (c.radius - body_sizes[k].radius);
    c.half_size = between(unpack(body_sizes[k].half_size), c.half_size, fraction);
  }
  return c;
}

// Of a box: what a place of it at the substep's start is multiplied by to be the same place at its end, in its axes.
vec3 growth_of(uint k, float from, float to) { return resizes ? collider_at(k, to).half_size / collider_at(k, from).half_size : vec3(1); }

bool changes_size(uint k, float from, float to) {
  if (!resizes) return false;
  const Collider before = collider_at(k, from), after = collider_at(k, to);
  return before.radius != after.radius || before.half_size != after.half_size;
}
