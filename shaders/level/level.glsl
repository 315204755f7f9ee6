// A level's iteration: every node evaluates its links at the iterate that the coarser levels leave, as in stretch.comp: XPBD by Jacobi with
// masses split. Links only pull: no two places of a cloth are farther apart than along it.
//
// A node, whose centre and middle centre.glsl tells, goes first where the next coarser level carries it; what it has gone in the end,
// level_steps, it hands on to the finer level and at last to the particles, by their shares. Where colliders hold what it carries it goes
// less far (support.glsl), but not with reactions.

GATHER_UINT4(level_node_shares)
GATHER_UINT4(level_links)
READ_WRITE(float, level_lambda)
READ(Detection, detection)

// Relaxation, over that of other passes. Links only pull, and of a node's, by whose number its mass is split, some are slack: so more than one
// goes. What is overdone flies back, at a relaxation of 2 as fast as it came, and more would gain energy.
const float kEager = WEFT_EAGER_LEVELS;

// Where a kinematic particle comes at cloth by more than a separation in a substep, and for a while after, links are a little slack
// (Detection::slack): what is ahead of it has to give way before it is met, or holds it up
// (ContactCase.a_held_sheet_carries_a_free_one_along_at_eight_metres_a_second: by up to 6.8 mm in a substep, for less than 1). Else they are
// not: slack for good, what hangs strains by a percent, and folds that touch flapped for ever.
//
// Where contacts are and something may drive cloth along, an iteration leaves of a link's length at least a part (Motion::level_kept): what
// anchors stretch for good, as a towel that is wrung, coarse links would crumple instead. Elsewhere they go all the way: cloth that falls on
// a ball strains by a quarter more where they do not.

// How far the next coarser level's, STEP, would carry node k, and what of their steps was held, over what put it out.
vec4 carried_freely(uint k, LevelNode node) {
  const uvec4 packed = FETCH(level_node_shares, k);
  if (packed.x == WEFT_NONE || node.inverse_mass == 0) return vec4(0);
  const LevelShare share = unpack_level_share(packed);
  return share.part0 * STEP(share.node0) + share.part1 * STEP(share.node1) + share.part2 * STEP(share.node2);
}

// How far they carry it.
vec3 carried_of(uint k, LevelNode node) {
  const vec3 step = carried_freely(k, node).xyz;
  return nodes_are_held ? yields(support_from(PUT_OUT(k).xyz), step) : step;
}

// How far node k goes, and what of it was held, over what put it out: what the node carries has been put out by parts of that.
vec4 step_of(uint k) {
  const LevelNode node = unpack_level_node(FETCH(level_nodes, k));
  if (node.inverse_mass == 0) return vec4(0);
  const vec4 carried = CARRIED(k, node);   // m, and inverse mass times links (1/kg)
  const vec3 centre = CENTRE(k).xyz, middle = MIDDLE(k).xyz;
  const bool first = (push.flags & WEFT_FIRST_ITERATION) != 0;
  const float omega = min(kEager * motion.relaxation, is_second_order ? WEFT_MOST_EAGER_2 : WEFT_MOST_EAGER);
  const float slack = has_contacts ? detection[0].slack : 0;
  vec3 sum = vec3(0);
  const uint end = node.first_link + node.links;
  for (uint begin = node.first_link; begin < end; begin += kLinksAtOnce) {   // as in centre.glsl
    LevelLink links[kLinksAtOnce];
    vec3 centres[kLinksAtOnce], middles[kLinksAtOnce];
    vec4 others_carried[kLinksAtOnce];
    for (uint j = 0; j < kLinksAtOnce; ++j) links[j] = unpack_level_link(FETCH(level_links, min(begin + j, end - 1)));
    for (uint j = 0; j < kLinksAtOnce; ++j) {
      const uint other = links[j].other;
      centres[j] = CENTRE(other).xyz;
      middles[j] = MIDDLE(other).xyz;
      others_carried[j] = CARRIED(other, unpack_level_node(FETCH(level_nodes, other)));
    }
    for (uint j = 0; j < kLinksAtOnce; ++j) {
      const uint l = begin + j;
      if (l >= end) break;
      const vec3 gone = carried.xyz - others_carried[j].xyz, d = middle - middles[j] + gone, pull = centre - centres[j] + gone;
      const float len = sqrt(dot(d, d) + 1e-20), alpha = links[j].compliance * motion.inverse_h2;
      const float lambda = is_iterated && !first ? level_lambda[l] : 0, weight = carried.w + others_carried[j].w + omega * alpha;
      const float at_most = slack > 0 ? (1 + slack) * links[j].rest : max(links[j].rest, motion.level_kept * len);
      const float change = min(omega * (at_most - len - alpha * lambda) / max(weight, 1e-20), -lambda);
      if (is_iterated) level_lambda[l] = lambda + change;
      sum += change / sqrt(dot(pull, pull) + 1e-20) * pull;
    }
  }
  vec4 gone = vec4(carried.xyz + node.inverse_mass * sum, 0);
  if (nodes_are_held) {
    const vec3 put_out = PUT_OUT(k).xyz, support = support_from(put_out);
    gone = carried_freely(k, node) + vec4(node.inverse_mass * sum, 0);
    gone.w += held_of(support, gone.xyz) / max(length(put_out), 1e-9);
    gone.xyz = yields(support, gone.xyz);
  }
  return dot(gone, gone) < 1e20 ? gone : vec4(0);   // a neighbour that is not finite must not spoil this node
}
