// list_places: where the lists of contact_list begin. Those that penetrate come after the active ones; the unsafe ones, listed at the
// substep's end, overwrite the active ones.

uint first_place(uint kind) { return kind == WEFT_PENETRATING ? contact_settings.capacity : 0; }
