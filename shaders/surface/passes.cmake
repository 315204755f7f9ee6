weft_passes(surface)
