# Shaders of the pictures; included by shaders/CMakeLists.txt.
foreach(file frame.h sky.glsl tone.glsl light.glsl)
  list(APPEND includes ${CMAKE_CURRENT_SOURCE_DIR}/shading/${file})
endforeach()
foreach(name cloth.vert cloth.frag solid.vert solid.frag screen.vert sky.frag occlusion.frag smooth.frag)
  weft_shader(shading/${name} shading/${name})
endforeach()
