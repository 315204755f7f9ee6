weft_passes(stretch)
