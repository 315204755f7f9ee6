weft_passes(
  cluster_box
  contact_alone contact_apply contact_finalize contact_limit contact_limit_rest contact_penetration contact_prepare contact_slide
  contact_slide_apply contact_solve contact_unsafe
  detect_alone detect_arguments detect_outline detect_pair detect_prepare detect_search detect_track
  grid_fill grid_search
  outline_edges outline_faces outline_particles
  pair_edges pair_faces
  search_edges search_faces search_rare)
