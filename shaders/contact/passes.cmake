weft_passes(
  contact_apply contact_arguments contact_finalize contact_limit contact_unsafe contact_prepare contact_solve contact_slide contact_slide_apply contact_penetration
  detect_arguments detect_trajectory
  grid_count grid_fill grid_scan grid_search grid_total
  outline
  pair_edges pair_faces
  search_edges search_faces)
