// grid: where a primitive can get to before the next detection, and a spatial hash of such boxes with a level for every size.
//
// A box belongs to the cell that holds its middle, on the first level whose cells are at least as long as it
// (cell * 2^level). Who looks for neighbours on a level widens his own box by the longest half side there, so one cell a
// primitive is enough, and on his own level or above that is at most three cells along each axis. Slots are shared by cells
// of any level that hash alike: an entry counts only in the cell and on the level that are its own.
//
// Boxes and cells are `precise`: counting, filling and searching must agree to the bit. Needs push and detection.

GATHER(references)
GATHER(paths)
GATHER(rest)

// Four units in the last place of the largest coordinate: what adding paths up and comparing places may lose.
const float rounding = 4.0 / 8388608.0;

float per_substep() { return 1.0 / float(max(detection[0].horizon, 1)); }

const uint of_triangles = 0, of_edges = 1;   // kinds of primitives

// A particle at the last detection, and what it would go from there in the horizon's substeps (m).
struct Track {
  vec3 at, path;
};

Track track_of(uint i) { return Track(FETCH(references, i).xyz, FETCH(paths, i).xyz); }

struct Sweep {
  vec3 low, high;    // corners of the box that the primitive's surface cannot leave (m)
  float step;        // what its fastest particle goes in a substep (m)
  float clearance;   // how far a particle can be from where its path has led so far (m)
};

Sweep sweep_of(vec3 low, vec3 high, float squared_path, float thickness) {
  const vec3 far = max(abs(low), abs(high));
  precise const float clearance = detection[0].reach + rounding * max(far.x, max(far.y, far.z));
  precise const float margin = clearance + 0.5 * thickness;
  precise const vec3 from = low - margin, to = high + margin;
  return Sweep(from, to, sqrt(squared_path) * per_substep(), clearance);
}

float squared_length(vec3 d) {
  precise const float squared = dot(d, d);
  return squared;
}

vec3 end_of(Track track) {
  precise const vec3 end = track.at + track.path;
  return end;
}

Sweep sweep_of(Track a, float thickness) {
  const vec3 end = end_of(a);
  return sweep_of(min(a.at, end), max(a.at, end), squared_length(a.path), thickness);
}

Sweep sweep_of(Track a, Track b, float thickness) {
  const vec3 c = end_of(a), d = end_of(b);
  return sweep_of(min(min(a.at, b.at), min(c, d)), max(max(a.at, b.at), max(c, d)),
                  max(squared_length(a.path), squared_length(b.path)), thickness);
}

Sweep sweep_of(Track a, Track b, Track c, float thickness) {
  const vec3 d = end_of(a), e = end_of(b), f = end_of(c);
  return sweep_of(min(min(min(a.at, b.at), c.at), min(min(d, e), f)), max(max(max(a.at, b.at), c.at), max(max(d, e), f)),
                  max(max(squared_length(a.path), squared_length(b.path)), squared_length(c.path)), thickness);
}

vec3 middle_of(Sweep sweep) {
  precise const vec3 middle = 0.5 * (sweep.low + sweep.high);
  return middle;
}

vec3 half_sides(Sweep sweep) {
  precise const vec3 half_size = 0.5 * (sweep.high - sweep.low);
  return half_size;
}

uint level_of(float half_side) {
  uint level = 0;
  for (float size = contact_settings.cell; level < WEFT_LEVELS - 1 && size < 2 * half_side; size *= 2) ++level;
  return level;
}

// Clamped far outside of any scene, where a cell's number would no longer be an integer of 32 bits.
ivec3 cell_at(vec3 x, uint level) {
  precise const float inverse = (1.0 / contact_settings.cell) * uintBitsToFloat((127 - level) << 23);   // 2^-level
  precise const vec3 scaled = x * (inverse * vec3(4, 1, 1));
  return ivec3(clamp(floor(scaled), -1e9, 1e9));
}

// Cells that follow each other along x have slots that do too (the last is followed by the first), so that a row of cells is one
// run of entries. Rows next to each other must not overlap more often than chance has it, whatever the number of slots.
uint slot_of(ivec3 cell, uint level, uint kind) {
  uint hash = uint(cell.y) * 19349663u + uint(cell.z) * 83492791u + (2 * level + kind) * 2654435761u;
  hash = (hash ^ (hash >> 15)) * 739982445u;
  return ((hash ^ (hash >> 13)) + uint(cell.x)) & (contact_settings.slots - 1);
}

// An entry's number: the primitive, and its level in the top four bits. Bit 27 is never set, so these are never a NaN's bits.
const uint level_shift = 28;
const uint primitive_mask = 0x0fffffff;
