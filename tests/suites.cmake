# Run after a test program is linked: asks it for its tests and makes of each suite one test of CTest, or two: tests that compare bits run
# on other threads (tests/CMakeLists.txt). A process a suite: by itself most of a test's time is what its process begins with, the device
# and the shaders that it specialises anew.
#
#   cmake -D program=FILE -D file=FILE -D label=NAME -D skipped=FILTER -D bits=REGEX -D long=SUITE,SUITE -P suites.cmake
execute_process(COMMAND ${program} --gtest_list_tests --gtest_filter=-${skipped} OUTPUT_VARIABLE listed RESULT_VARIABLE failed TIMEOUT 60)
if(failed)
  message(FATAL_ERROR "${program} does not list its tests: ${failed}")
endif()
string(REPLACE "," ";" long "${long}")
set(script "")

# A test of CTest, of these tests, with that many threads of the software driver.
function(add name threads)
  string(REPLACE ";" ":" filter "${ARGN}")
  list(FIND long ${name} place)
  set(cost 0)
  if(NOT place EQUAL -1)
    list(LENGTH long cost)
    math(EXPR cost "${cost} - ${place}")   # the longest first
  endif()
  string(APPEND script "add_test([[${name}]] [[${program}]] [[--gtest_filter=${filter}]])\n")
  string(APPEND script
    "set_tests_properties([[${name}]] PROPERTIES LABELS ${label} TIMEOUT 1200 COST ${cost} ENVIRONMENT LP_NUM_THREADS=${threads})\n")
  set(script "${script}" PARENT_SCOPE)
endfunction()

macro(end_suite)
  if(others)
    add(${suite} 0 ${others})
  endif()
  if(same_bits)
    add(${suite}.bits 3 ${same_bits})
  endif()
  set(others "")
  set(same_bits "")
endmacro()

string(REGEX REPLACE " *#[^\n]*" "" listed "${listed}")   # values of parameters
string(REPLACE "\n" ";" lines "${listed}")
set(suite "")
set(others "")
set(same_bits "")
foreach(line IN LISTS lines)
  if(line MATCHES "^([^ ]+)\\.$")
    end_suite()
    set(suite ${CMAKE_MATCH_1})
  elseif(line MATCHES "^  ([^ ]+)$" AND suite)
    set(test ${CMAKE_MATCH_1})
    if(test MATCHES "${bits}")
      list(APPEND same_bits ${suite}.${test})
    else()
      list(APPEND others ${suite}.${test})
    endif()
  endif()
endforeach()
end_suite()
if(NOT script)
  message(FATAL_ERROR "${program} lists no tests")
endif()
file(WRITE ${file} "${script}")
