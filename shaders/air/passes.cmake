weft_passes(air air_stir air_wake)
