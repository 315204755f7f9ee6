# weft_test_kernel(target name source environment): compiles <source>, of the folder at hand, for a target environment of glslang, and
# gives the target a header <name>.h with the words as the array <name>. What it includes follows.
find_program(GLSLANG glslangValidator REQUIRED)

function(weft_test_kernel target name source environment)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${target}_kernels)
  set(header ${folder}/${name}.h)
  file(MAKE_DIRECTORY ${folder})
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${GLSLANG} --quiet -V --target-env ${environment} -I${PROJECT_SOURCE_DIR} --vn ${name}
            ${CMAKE_CURRENT_SOURCE_DIR}/${source} -o ${header}
    DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${source} ${ARGN}
    COMMENT "Test kernel ${name}"
    VERBATIM)
  target_sources(${target} PRIVATE ${header})
  target_include_directories(${target} PRIVATE ${folder})
endfunction()

# The kernels of the compute room's own tests.
function(weft_reflect_test_kernels target)
  weft_test_kernel(${target} touch_vulkan10 compute/kernels/touch.comp vulkan1.0)
  weft_test_kernel(${target} touch_vulkan12 compute/kernels/touch.comp vulkan1.2)
  weft_test_kernel(${target} touch_vulkan13 compute/kernels/touch.comp vulkan1.3)
endfunction()

function(weft_recorder_test_kernels target)
  weft_test_kernel(${target} scale compute/kernels/scale.comp vulkan1.2)
  weft_test_kernel(${target} arguments compute/kernels/arguments.comp vulkan1.2)
endfunction()
