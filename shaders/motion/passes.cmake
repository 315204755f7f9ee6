weft_passes(finalize predict)
