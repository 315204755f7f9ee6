// limit_rest: rounds of contact_limit by one workgroup, until nothing changes. Needs contact/limit.glsl, contact/list_places.glsl,
// wait.glsl and LISTED(kind, place).

// What a workgroup may do without its loops being ended: the same whether or not it has done all else before, which may take half of it.
uint most_rounds(uint unsafe) {
  const uint turns = (unsafe + workgroup - 1) / workgroup + 1;
  return clamp(contact_settings.most_turns / (2 * turns), WEFT_WIDE_ROUNDS + 1, WEFT_LIMIT_ROUNDS);
}

void limit_from(uint thread, uint round) {
  const uint unsafe = detection[0].listings[WEFT_UNSAFE], most = most_rounds(unsafe);
  for (; round < most; ++round) {
    if (round > 0 && detection[0].changed[(round - 1) % 3] == 0) return;
    if (thread == 0) detection[0].changed[(round + 1) % 3] = 0;
    for (uint k = thread; k < unsafe; k += workgroup) limit(LISTED(WEFT_UNSAFE, k), round);
    wait();
  }
  if (detection[0].changed[(most - 1) % 3] == 0) return;
  for (uint k = thread; k < unsafe; k += workgroup) ask_to_fall_back(LISTED(WEFT_UNSAFE, k), most);
  wait();
  if (detection[0].falls_back == 0) return;
  for (uint k = thread; k < unsafe; k += workgroup) fall_back(LISTED(WEFT_UNSAFE, k), most);
  wait();
}
