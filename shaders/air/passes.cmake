weft_passes(air air_stir)
