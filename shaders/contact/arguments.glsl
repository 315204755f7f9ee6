// arguments: what detect_arguments does. Needs contact/groups.glsl, Detection and Counters.

const float grow = 1.5, shrink = 0.7;
const uint most_a_particle = 2, usual_particles = 4000;   // candidates; fewer particles have no more than these would
const uint too_soon = 3, usual_horizon = 6;               // substeps

// The least bound (m). `many`: candidates are.
float least_after(float least, bool many) {
  if (least <= 0) return contact_settings.margin_low;
  if (many) return max(shrink * least, contact_settings.margin_low);
  const bool cheap = detection[0].candidates < max(contact_settings.particles, usual_particles) / 4;
  return cheap || detection[0].served < too_soon ? min(grow * least, contact_settings.margin_high) : least;
}

// Twice as long as the last candidates served. Where motion is jerky and every other substep asks for a detection, trajectories of ten
// substeps would have half as many candidates again.
uint lifetime_after(uint steps) { return detection[0].lifetime == 0 ? WEFT_LONGEST_LIFETIME : min(2 * steps, WEFT_LONGEST_LIFETIME); }

void begin_detection(bool settled) {
  detection[0].served = detection[0].steps + 1;
  detection[0].served_lifetime = detection[0].lifetime;
  const bool untangled = untangles && detection[0].crossings != 0;   // then the next substep has a detection in any case
  detection[0].lifetime = untangled ? 1 : lifetime_after(detection[0].steps + 1);
  const bool many = detection[0].candidates > most_a_particle * max(contact_settings.particles, usual_particles);
  detection[0].horizon = many ? detection[0].lifetime : max(detection[0].lifetime, usual_horizon);
  detection[0].margin = untangled ? 2 * contact_settings.margin_low : contact_settings.margin_high;
  detection[0].least = untangled ? contact_settings.margin_low : least_after(detection[0].least, many);
  const float fastest = uintBitsToFloat(detection[0].fastest);
  detection[0].most_pushed = fastest > contact_settings.margin_low ? min(fastest, WEFT_MOST_PUSHED * contact_settings.cell) : 0;
  detection[0].needs_detection = 0;
  detection[0].settled = uint(settled);
  detection[0].steps = 0;
  detection[0].candidates = 0;
  detection[0].near[0] = detection[0].near[1] = detection[0].levels = 0;
  if (untangles) {
    detection[0].looks = uint(detection[0].may_cross != 0 || detection[0].crossings != 0);
    detection[0].may_cross = detection[0].crossings = 0;
  }
  detection[0].near_faces = detection[0].near_edges = Groups(0, 1, 1);   // the search adds to them
  detection[0].near_pairs = Groups(0, 2, 1);
  for (uint k = 0; k < WEFT_LEVELS; ++k) detection[0].extents[k] = 0;
  detection[0].contacts = detection[0].paired = detection[0].alone = Groups(0, 1, 1);   // and the narrow phase to these
  const uint particles = contact_settings.particles, primitives = contact_settings.triangles + contact_settings.edges;
  detection[0].outlined = groups_of(particles + primitives + contact_settings.clusters);
  detection[0].grid = Groups(1, 1, 1);
  detection[0].clusters = thin_groups_of(contact_settings.clusters);
  detection[0].particles = groups_of(particles);
  detection[0].faces = groups_of(contact_settings.triangles);
  detection[0].edges = groups_of(contact_settings.edges);
  const Groups none = Groups(0, 1, 1), all = groups_of(particles + contact_settings.edges);
  detection[0].searchers = detection[0].prepared = all;
  detection[0].rare = untangles && detection[0].looks != 0 ? all : none;
  ++counters[0].detections;
}

void skip_detection() {
  detection[0].steps = min(detection[0].steps + 1, WEFT_LONGEST_LIFETIME);
  const Groups none = Groups(0, 1, 1);
  detection[0].outlined = none;
  detection[0].grid = none;
  detection[0].clusters = none;
  detection[0].particles = none;
  detection[0].faces = none;
  detection[0].edges = none;
  detection[0].rare = none;
  detection[0].near_faces = none;
  detection[0].near_edges = none;
  detection[0].near_pairs = none;
  detection[0].searchers = none;
  detection[0].prepared = detection[0].contacts;
}

// Those of the substep before.
void empty_lists() {
  if (untangles) detection[0].tangles = Groups(0, 1, 1);
  counters[0].contacts_load = min(detection[0].candidates, contact_settings.capacity) + 10 * detection[0].listings[WEFT_ACTIVE];
  for (uint entry = 0; entry < 3; ++entry) detection[0].changed[entry] = 0;
  detection[0].falls_back = 0;
  detection[0].touchings = 0;
  detection[0].touched = Groups(0, 1, 1);
  for (uint kind = 0; kind < 3; ++kind) {
    detection[0].listings[kind] = 0;
    detection[0].listed[kind] = Groups(0, 1, 1);
  }
}

void decide() {
  empty_lists();
  const bool needed = detection[0].needs_detection != 0;
  const bool settled = !needed && detection[0].steps >= WEFT_LONGEST_LIFETIME && detection[0].settled == 0 &&
                       detection[0].candidates > contact_settings.particles;
  if (needed || settled) begin_detection(settled);
  else skip_detection();
  detection[0].fastest = 0;
  detection[0].stirred += detection[0].stirs;
  detection[0].stirs = 0;
  detection[0].slack = max(detection[0].slack - WEFT_LEVEL_SLACK / WEFT_SLACK_LASTS, 0);
}
