// round_cone: a capsule whose ends have two radii, the convex hull of two spheres. In its axes the spheres' centres lie at c - h and c + h
// on the y axis, c = half_size.x and h = half_size.y. On the way up the radius falls evenly, by b = half_size.z a metre: at height y it is
// R - b (y - c). All normals of the side rise by b, the sine of half the cone's angle, so a point's nearest place of the core is not beside
// it but b / sqrt(1 - b^2) times its distance from the axis lower. From there on it is a capsule (Quilez, "Round cone", has the same
// distance by cases). Where one sphere holds the other the host makes h and b 0, and c the height of the larger. Needs Hit and entry_root.
//
//        .--.        c + h, radius R - b h
//       /    \ .
//      /      \    <- normals rise by b
//     |   +    |     c - h, radius R + b h
//      \      /
//       `----'

float cosine_of_taper(float b) { return sqrt(1 - b * b); }

// The height of the core's place that is nearest to p.
float nearest_height(vec3 half_size, vec3 p) {
  const float slope = half_size.z / cosine_of_taper(half_size.z);
  return half_size.x + clamp(p.y - half_size.x - slope * length(p.xz), -half_size.y, half_size.y);
}

float radius_at(float radius, vec3 half_size, float height) { return radius - half_size.z * (height - half_size.x); }

Hit round_cone_distance(float radius, vec3 half_size, vec3 p) {
  const float height = nearest_height(half_size, p);
  const vec3 d = p - vec3(0, height, 0);
  const float len = length(d);
  const vec3 sideways = vec3(cosine_of_taper(half_size.z), half_size.z, 0);   // from the axis every way to the side is as good
  return Hit(len > 1e-9 ? d / len : sideways, len - radius_at(radius, half_size, height));
}

// Where the segment from a enters the side, between the ends' spheres. On the cone the distance from the axis, times `cosine`, is
// s = R - b (y - c), so that t is a root of the difference of their squares, A t^2 + 2 B t + C, at which it falls.
float side_entry(float radius, vec3 half_size, vec3 a, vec3 segment) {
  const float b = half_size.z, cosine = cosine_of_taper(b);
  const vec2 wide = cosine * a.xz, way = cosine * segment.xz;
  const float s = radius_at(radius, half_size, a.y), fall = b * segment.y;
  const float A = dot(way, way) - fall * fall, B = dot(wide, way) + s * fall;
  float t = kNever;
  if (A > 0.1 * dot(segment, segment)) {   // as in entry_root, half a chord before the place that is deepest
    t = -B / A;
    const float off = length(wide + t * way), there = s - t * fall;
    const float half_chord = (there - off) * (there + off);
    t = half_chord >= 0 ? t - sqrt(half_chord / A) : kNever;
  } else {   // almost along the side, or steeper
    const float C = (length(wide) - s) * (length(wide) + s), root = sqrt(max(B * B - A * C, 0));
    if (B * B - A * C >= 0) t = B < 0 ? C / (root - B) : A < 0 ? (B + root) / -A : kNever;
  }
  const vec3 p = a + t * segment;
  const float lowered = p.y - half_size.x - b / cosine * length(p.xz);
  return t >= 0 && t < 1 && radius_at(radius, half_size, p.y) > 0 && abs(lowered) <= half_size.y ? t : kNever;
}

// The body is two spheres and the side between them: a segment that begins outside enters it where it enters the first of these.
Hit round_cone_entry(float radius, vec3 half_size, vec3 a, vec3 segment) {
  if (!(round_cone_distance(radius, half_size, a).at >= 0)) return Hit(vec3(0), kNever);
  float first = side_entry(radius, half_size, a, segment);
  for (int end = -1; end <= 1; end += 2) {
    const float height = half_size.x + end * half_size.y;
    const float t = entry_root(a - vec3(0, height, 0), segment, radius_at(radius, half_size, height));
    if (t >= 0 && t < first) first = t;
  }
  if (!(first < 1)) return Hit(vec3(0), kNever);
  return Hit(round_cone_distance(radius, half_size, a + first * segment).normal, first);
}
