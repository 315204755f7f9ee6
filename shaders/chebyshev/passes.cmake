weft_passes(chebyshev)
