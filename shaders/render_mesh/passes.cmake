weft_passes(render_mesh)
