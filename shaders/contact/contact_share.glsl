// contact_share: what a contact lacks on the current iterate, and how the contacts of a particle divide its mass.
//
// Masses are split (Tonge et al. 2012), as in stretch.comp, but not evenly: of a particle's mass a contact has the share
// s = v / V, where v = |w| depth is what it lacks there and V the sum over the particle's contacts. In a corner or a fold one contact in a
// dozen carries the load, and the others are satisfied to a hair: split evenly it would make good a dozenth of what it lacks in an
// iteration, and contact_limit had to hold the cloth. Whatever the shares are, their sum is 1: momentum is kept and no
// particle is pushed further than its contacts ask for.

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER(contact_weights)
GATHER_UINT(contact_counts)
GATHER_UINT(contact_list)
READ(Detection, detection)

struct Touch {
  Candidate pair;
  vec4 normal, weights;
  mat4x3 iterate;     // m, relative to the first particle
  float depth;        // m
  bool pushes;
};

Touch touch_at(uint place) {
  const uint i = FETCH_UINT(contact_list, place);
  Touch touch;
  touch.pair = unpack_candidate(FETCH(candidates, i));
  touch.normal = FETCH(contact_normals, i);
  touch.weights = FETCH(contact_weights, i);
  const vec3 origin = FETCH(predicted, touch.pair.particle[0]).xyz;
  touch.iterate = mat4x3(vec3(0), FETCH(predicted, touch.pair.particle[1]).xyz - origin, FETCH(predicted, touch.pair.particle[2]).xyz - origin,
                         FETCH(predicted, touch.pair.particle[3]).xyz - origin);
  // precise: what is added up and what is taken as a share of the sum must be the same.
  precise const vec3 between = touch.iterate * touch.weights;
  precise const float depth = touch.normal.w - dot(touch.normal.xyz, between);
  touch.depth = depth;
  touch.pushes = touch.depth > 0 && touch.depth < 1e10;
  return touch;
}

// v in units of `quantum`, at least one, so that no share is zero, and few enough that V does not overflow: of what runs through that far all
// contacts count alike.
uint lack_of(float weight, float depth, uint uses) {
  if (weight == 0) return 0;
  const float most = 2147483648.0 / float(max(uses, 16));
  return uint(clamp(abs(weight) * depth / contact_settings.quantum, 1, most));
}
