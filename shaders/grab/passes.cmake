weft_passes(grab)
