weft_passes(skin)
