weft_passes(gauss_seidel)
