# Shaders of the pictures. Nobody specialises them, so they are optimised here.
foreach(name cloth.vert cloth.frag solid.vert solid.frag screen.vert sky.frag occlusion.frag smooth.frag)
  weft_shader(shading/${name} ${name} -O)
endforeach()
