# WEFT_EFFECTS: the names in engine/effects/list.h. weft_add_effects: adds the subdirectory of each effect that has one with a
# CMakeLists.txt.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/list.h)
file(READ ${CMAKE_CURRENT_LIST_DIR}/list.h WEFT_EFFECTS)
string(REGEX MATCHALL "\n  EFFECT\\([a-z0-9_]+\\)" WEFT_EFFECTS "${WEFT_EFFECTS}")
list(TRANSFORM WEFT_EFFECTS REPLACE "^.*\\((.+)\\)$" "\\1")

macro(weft_add_effects)
  foreach(effect IN LISTS WEFT_EFFECTS)
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${ARGV0}${effect}/CMakeLists.txt)
      add_subdirectory(${ARGV0}${effect})
    endif()
  endforeach()
endmacro()
