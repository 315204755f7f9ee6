// limit_rest: rounds of contact_limit by one workgroup, until nothing changes. Needs contact/limit.glsl, contact/list_places.glsl,
// contact/wait.glsl and LISTED(kind, place).

const uint kTurnsOfRound = 16;   // of loops, for an unsafe candidate

// What a workgroup may do without its loops being ended.
uint most_rounds(uint unsafe) {
  const uint share = (unsafe + workgroup - 1) / workgroup;
  return clamp(contact_settings.most_turns / (2 * kTurnsOfRound * max(share, 1)), WEFT_WIDE_ROUNDS + 1, WEFT_LIMIT_ROUNDS);
}

void limit_from(uint thread, uint round) {
  const uint unsafe = detection[0].listings[WEFT_UNSAFE], most = most_rounds(unsafe);
  for (; round < most; ++round) {
    if (round > 0 && detection[0].changed[(round - 1) % kTurns] == 0) return;
    if (thread == 0) detection[0].changed[(round + 1) % kTurns] = 0;
    for (uint k = thread; k < unsafe; k += workgroup) limit(LISTED(WEFT_UNSAFE, k), round);
    wait();
  }
  if (detection[0].changed[(most - 1) % kTurns] == 0) return;
  for (uint k = thread; k < unsafe; k += workgroup) fall_back(LISTED(WEFT_UNSAFE, k), most);
  wait();
}
