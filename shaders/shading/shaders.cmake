# Shaders of the pictures.
foreach(name cloth.vert cloth.frag cut.vert cut.frag solid.vert solid.frag screen.vert sky.frag occlusion.frag smooth.frag)
  weft_shader(shading/${name} ${name})
endforeach()
