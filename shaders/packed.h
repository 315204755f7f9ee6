// What is packed into the bits of a buffer's elements: links and candidates. Part of shared.h, which includes it.
#ifndef WEFT_PACKED_H
#define WEFT_PACKED_H

#ifdef __cplusplus
namespace weft::gpu {
#endif

// A link of the stretch pass in eight bytes: 24 bits of index, a rest length from 2^-31 m to 2^32 m with 18 bits of mantissa (relative
// error up to 2^-19), a response with 7 (below 0.4 %), and one bit for links that only pull.
//
// With one iteration a substep nothing in an XPBD multiplier changes but C, so the response is the gain 1 / (W_a + W_b + omega alpha/h^2)
// (kg; engine/fabric.cpp says why omega), computed when cooking: the pass neither adds masses nor divides by them. Both ends have the
// same bits of it, so momentum is conserved. With several iterations the response is the compliance alpha (m/N).
//
//   x: [31..24] response exponent   [23..0] index
//   y: [31..8]  rest length / 2^95, a positive float's bits 28..5   [7..1] response mantissa   [0] only pulls
#define WEFT_REST_UNIT 39614081257132168796771975168.0f   // 2^95: six bits of exponent are enough for a length

struct Link {
  uint other;
  float rest;         // m; 0 marks padding
  float response;     // gain (kg) or compliance (m/N)
  bool only_pulls;
};

WEFT_INLINE Link unpack_link(uint x, uint y) {
  Link link;
  link.other = x & 0xffffffu;
  link.rest = WEFT_FLOAT((y >> 8) << 5) * WEFT_REST_UNIT;
  link.response = WEFT_FLOAT(((x >> 24) << 23) | ((y & 0xfeu) << 15));
  link.only_pulls = (y & 1u) != 0u;
  return link;
}

// A link of a patch in eight bytes: both ends as members of the patch, and all that the link of the stretch pass keeps of a rest length
// and of a compliance.
//
//   x: [31..16] compliance, the upper half of a float   [15..8] b   [7..0] a
//   y: rest length, a float whose lowest bit marks a link that only pulls
struct PatchLink {
  uint a, b;
  float rest;         // m
  float compliance;   // m/N
  bool only_pulls;
};

WEFT_INLINE PatchLink unpack_patch_link(uvec2 packed) {
  PatchLink link;
  link.a = packed.x & 0xffu;
  link.b = (packed.x >> 8) & 0xffu;
  link.rest = WEFT_FLOAT(packed.y & 0xfffffffeu);
  link.compliance = WEFT_FLOAT(packed.x & 0xffff0000u);
  link.only_pulls = (packed.y & 1u) != 0u;
  return link;
}

// A link whose rest length is shifted (shift/shift.glsl), in 16 bytes: both ends as particles of 24 bits, in the top byte of the first the
// lowest one of the link's second word, its rest length, and in units of 1/65535 what of its error a frame adds to the shift and what of the
// shift a frame keeps.
struct ShiftedLink {
  uint a, b;
  uint low;     // of the words above, what is no rest length
  float rest;   // m; 0 marks padding
  float gain, kept;
};

WEFT_INLINE ShiftedLink unpack_shifted_link(uvec4 packed) {
  ShiftedLink link;
  link.a = packed.x & 0xffffffu;
  link.low = packed.x >> 24;
  link.b = packed.y;
  link.rest = WEFT_FLOAT(packed.z);
  link.gain = float(packed.w & 0xffffu) / 65535.0f;
  link.kept = float(packed.w >> 16) / 65535.0f;
  return link;
}

// What three nodes of a level have in a displacement, in 16 bytes; their parts, from -2 to 2, sum to one. Those of the second and third are
// told, in units of 1/16384.
struct LevelShare {
  uint node0, node1, node2;
  float part0, part1, part2;
};

WEFT_INLINE LevelShare unpack_level_share(uvec4 packed) {
  LevelShare share;
  share.node0 = packed.x;
  share.node1 = packed.y;
  share.node2 = packed.z;
  share.part1 = float(packed.w & 0xffffu) / 16384.0f - 2.0f;
  share.part2 = float(packed.w >> 16) / 16384.0f - 2.0f;
  share.part0 = 1.0f - share.part1 - share.part2;
  return share;
}

// A node of a coarse level in 16 bytes (level/level.glsl), and a link of its.
struct LevelNode {
  uint first_gather;    // of what it is the mean of; they end where the next node's begin
  float inverse_mass;   // 1/kg; 0: it is held
  uint first_link, links;
};

// A point of the finer level as a node has it, in 8 bytes: weights of 16 bits, the centre's between -1 and 1, the middle's between 0 and 1.
struct LevelGather {
  uint point;           // particle or node
  float in_centre, in_middle;
};

WEFT_INLINE LevelGather unpack_level_gather(uvec2 packed) {
  LevelGather gather;
  gather.point = packed.x;
  gather.in_centre = float(packed.y & 0xffffu) / 32768.0f - 1.0f;
  gather.in_middle = float(packed.y >> 16) / 65535.0f;
  return gather;
}

struct LevelLink {
  uint other;           // node
  float rest;           // m, along the cloth
  float compliance;     // m/N
};

WEFT_INLINE LevelNode unpack_level_node(uvec4 packed) {
  LevelNode node;
  node.first_gather = packed.x;
  node.inverse_mass = WEFT_FLOAT(packed.y);
  node.first_link = packed.z;
  node.links = packed.w;
  return node;
}

WEFT_INLINE LevelLink unpack_level_link(uvec4 packed) {
  LevelLink link;
  link.other = packed.x;
  link.rest = WEFT_FLOAT(packed.y);
  link.compliance = WEFT_FLOAT(packed.z);
  return link;
}

// A candidate in 16 bytes: four particles of 24 bits, and in their top bytes, first to last, the bits of the separation
// (m), whose sign tells the kind. Vertex-triangle: the vertex is side A, the triangle side B. Edge-edge: two and two.
struct Candidate {
  uint particle[4];
  float separation;         // m
  bool edges;
};

WEFT_INLINE Candidate unpack_candidate(uvec4 packed) {
  const uint bits = (packed.x & 0xff000000u) | ((packed.y >> 24) << 16) | ((packed.z >> 24) << 8) | (packed.w >> 24);
  Candidate candidate;
  candidate.particle[0] = packed.x & 0xffffffu;
  candidate.particle[1] = packed.y & 0xffffffu;
  candidate.particle[2] = packed.z & 0xffffffu;
  candidate.particle[3] = packed.w & 0xffffffu;
  candidate.separation = WEFT_FLOAT(bits & 0x7fffffffu);
  candidate.edges = (bits & 0x80000000u) != 0u;
  return candidate;
}

WEFT_INLINE uvec4 pack_candidate(uint a, uint b, uint c, uint d, float separation, bool edges) {
  const uint bits = WEFT_BITS(separation) | (edges ? 0x80000000u : 0u);
  uvec4 packed;
  packed.x = a | (bits & 0xff000000u);
  packed.y = b | (((bits >> 16) & 0xffu) << 24);
  packed.z = c | (((bits >> 8) & 0xffu) << 24);
  packed.w = d | (bits << 24);
  return packed;
}

#ifdef __cplusplus

/// Rest length and compliance are those of an unpacked Link.
inline uvec2 pack_patch_link(const PatchLink& link) {
  return {link.a | link.b << 8 | (WEFT_BITS(link.compliance) & 0xffff0000u), (WEFT_BITS(link.rest) & 0xfffffffeu) | (link.only_pulls ? 1u : 0u)};
}

inline uvec4 pack_shifted_link(const ShiftedLink& link) {
  const auto whole = [](float part) { return static_cast<uint>((part < 0 ? 0 : part < 1 ? part : 1) * 65535 + 0.5f); };
  return {link.a | link.low << 24, link.b, WEFT_BITS(link.rest), whole(link.gain) | whole(link.kept) << 16};
}

inline uvec4 pack_level_node(const LevelNode& node) { return {node.first_gather, WEFT_BITS(node.inverse_mass), node.first_link, node.links}; }
inline uvec2 pack_level_gather(const LevelGather& gather) {
  const auto whole = [](double weight, double one) { return static_cast<uint>(weight < 0 ? 0 : weight * one + 0.5 > 65535 ? 65535 : weight * one + 0.5); };
  return {gather.point, whole(gather.in_centre + 1.0, 32768) | whole(gather.in_middle, 65535) << 16};
}

inline uvec4 pack_level_link(const LevelLink& link) { return {link.other, WEFT_BITS(link.rest), WEFT_BITS(link.compliance), 0}; }

inline uvec4 pack_level_share(const uint (&nodes)[3], double part1, double part2) {
  const auto whole = [](double part) { return static_cast<uint>((part + 2) * 16384 + 0.5); };
  return {nodes[0], nodes[1], nodes[2], whole(part1) | whole(part2) << 16};
}

inline uvec2 pack_link(const Link& link) {
  constexpr float kShortest = 0x1p-31f, kLongest = 0x1.ffffcp31f;   // m: what is shorter is nothing
  const float length = link.rest < kShortest ? 0 : link.rest < kLongest ? link.rest : kLongest;
  // Rounded to nearest: half of the last kept bit is added before cutting; a carry runs into the exponent, as it should.
  const uint rest = (WEFT_BITS(length / WEFT_REST_UNIT) + 0x10u) >> 5;
  const uint response = (WEFT_BITS(link.response) + 0x8000u) & 0x7fff0000u;
  return {(link.other & 0xffffffu) | ((response >> 23) << 24), (rest << 8) | ((response >> 15) & 0xfeu) | (link.only_pulls ? 1u : 0u)};
}

}  // namespace weft::gpu

#endif
#endif
