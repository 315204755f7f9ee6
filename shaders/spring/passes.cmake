weft_passes(spring)
