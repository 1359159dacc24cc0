# quiesce_add_unity_test(NAME SOURCES file.c ... [LIBRARIES lib ...] [INCLUDES dir ...]
#                        [EMULATOR_ARGS arg ...] [TIMEOUT s])
#
# A Unity test program and its ctest entry. Native builds run it directly; others link start-up and
# semihosting where there is no operating system, and run it under the emulator of their toolchain
# file (CMAKE_CROSSCOMPILING_EMULATOR). main returns UNITY_END(), which is the exit code of all.
# LIBRARIES defaults to quiesce_core.

function(quiesce_add_unity_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBRARIES;INCLUDES;EMULATOR_ARGS" ${ARGN})
  if(NOT ARG_LIBRARIES)
    set(ARG_LIBRARIES quiesce_core)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 60)
  endif()
  _quiesce_unity_library()

  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${ARG_INCLUDES})
  target_link_libraries(${name} PRIVATE quiesce_unity ${ARG_LIBRARIES} quiesce_warnings)
  quiesce_add_emulated_test(${name} ARGS ${ARG_EMULATOR_ARGS} TIMEOUT ${ARG_TIMEOUT})
endfunction()

# quiesce_add_emulated_test(TARGET [ARGS arg ...] [TIMEOUT s]): runs a program as a test, as an image
# where there is no operating system. Passes when it ends by itself with exit code 0; ARGS go to the
# emulator.
function(quiesce_add_emulated_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "ARGS" ${ARGN})
  if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
    quiesce_image(${name})
  endif()
  if(ARG_ARGS)
    list(INSERT CMAKE_CROSSCOMPILING_EMULATOR 1 ${ARG_ARGS})
    set_target_properties(${name} PROPERTIES CROSSCOMPILING_EMULATOR "${CMAKE_CROSSCOMPILING_EMULATOR}")
  endif()
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT})
endfunction()

function(_quiesce_unity_library)
  if(TARGET quiesce_unity)
    return()
  endif()
  if(NOT EXISTS ${UNITY_DIR}/unity.c)
    message(FATAL_ERROR "no unity.c in ${UNITY_DIR}: run ./tools/test once, or configure with "
                        "-DUNITY_DIR=FOLDER that holds unity.c, unity.h and unity_internals.h")
  endif()
  add_library(quiesce_unity STATIC ${UNITY_DIR}/unity.c)
  target_include_directories(quiesce_unity SYSTEM PUBLIC ${UNITY_DIR})
  target_include_directories(quiesce_unity PUBLIC ${PROJECT_SOURCE_DIR}/tests/unit/support)
  target_compile_definitions(quiesce_unity PUBLIC UNITY_INCLUDE_CONFIG_H)
  if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
    target_link_libraries(quiesce_unity PUBLIC hal_image)
  endif()
endfunction()
