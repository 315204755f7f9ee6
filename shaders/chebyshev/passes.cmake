weft_passes(accelerate)
