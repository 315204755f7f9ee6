# weft_test_kernel(target name source environment): compiles kernels/<source> for a target environment of glslang, and
# gives the target a header <name>.h with the words as the array <name>. What it includes follows.
find_program(GLSLANG glslangValidator REQUIRED)

function(weft_test_kernel target name source environment)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${target}_kernels)
  set(header ${folder}/${name}.h)
  file(MAKE_DIRECTORY ${folder})
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${GLSLANG} --quiet -V --target-env ${environment} --vn ${name}
            ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/kernels/${source} -o ${header}
    DEPENDS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/kernels/${source} ${ARGN}
    COMMENT "Test kernel ${name}"
    VERBATIM)
  target_sources(${target} PRIVATE ${header})
  target_include_directories(${target} PRIVATE ${folder})
endfunction()

# The kernels of the compute room's own tests.
function(weft_reflect_test_kernels target)
  weft_test_kernel(${target} touch_vulkan10 touch.comp vulkan1.0)
  weft_test_kernel(${target} touch_vulkan12 touch.comp vulkan1.2)
  weft_test_kernel(${target} touch_vulkan13 touch.comp vulkan1.3)
endfunction()

function(weft_recorder_test_kernels target)
  weft_test_kernel(${target} scale scale.comp vulkan1.2)
  weft_test_kernel(${target} arguments arguments.comp vulkan1.2)
endfunction()

function(weft_proximity_test_kernel target)
  weft_test_kernel(${target} proximity proximity.comp vulkan1.2 ${PROJECT_SOURCE_DIR}/shaders/proximity.glsl)
endfunction()
