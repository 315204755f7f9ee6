weft_passes(strand)
