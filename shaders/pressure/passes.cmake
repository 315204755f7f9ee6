weft_passes(pressure_volume pressure)
