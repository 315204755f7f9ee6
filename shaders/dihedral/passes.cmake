weft_passes(dihedral dihedral_gather)
