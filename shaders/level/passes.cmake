weft_passes(level_low level_spread level_wide)
