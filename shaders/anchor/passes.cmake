weft_passes(anchor)
