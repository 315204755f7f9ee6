weft_passes(untangle)
