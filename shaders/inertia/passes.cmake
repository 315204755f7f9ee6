weft_passes(inertia)
