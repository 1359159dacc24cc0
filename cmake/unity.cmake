# quiesce_add_unity_test(NAME SOURCES file.c ... [LIBRARIES lib ...] [INCLUDES dir ...]
#                        [EMULATOR_ARGS arg ...] [TIMEOUT s])
#
# A Unity test program and its ctest entry. Native builds run it directly; the mps2 build links
# start-up and semihosting and runs it under qemu-system-arm. main returns UNITY_END(), which is the
# exit code on both. LIBRARIES defaults to quiesce_core.

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
  if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
    quiesce_mps2_image(${name})
    quiesce_add_emulator_test(${name} ARGS ${ARG_EMULATOR_ARGS} TIMEOUT ${ARG_TIMEOUT})
  else()
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT})
  endif()
endfunction()

# quiesce_add_emulator_test(TARGET [ARGS arg ...] [TIMEOUT s]): runs an mps2 image as a test. Passes
# when the image ends by itself with exit code 0; ARGS go to qemu-system-arm.
function(quiesce_add_emulator_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "ARGS" ${ARGN})
  find_program(QEMU_SYSTEM_ARM qemu-system-arm)
  if(NOT QEMU_SYSTEM_ARM)
    message(FATAL_ERROR "qemu-system-arm not found: install it (Debian: qemu-system-arm)")
  endif()
  add_test(NAME ${name}
           COMMAND ${QEMU_SYSTEM_ARM} -M mps2-an386 -display none -monitor none -serial none
                   -semihosting-config enable=on,target=native ${ARG_ARGS}
                   -kernel $<TARGET_FILE:${name}>)
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
    target_link_libraries(quiesce_unity PUBLIC hal_mps2)
  endif()
endfunction()
