# libgpiod, whose versions 1 and 2 share almost no call: targets gpiod_1 and gpiod_2, each where it
# can be had, and QUIESCE_GPIOD, the one that programs link.
#
# The system's library is taken as it is (Debian: libgpiod-dev). The other 2.x is built from the
# sources in QUIESCE_GPIOD_DIR (tools/setup test fetches them) as a shared library: it is LGPL.

set(QUIESCE_GPIOD_DIR "${PROJECT_SOURCE_DIR}/build/deps/gpiod" CACHE PATH
    "Folder with lib/ and include/ of libgpiod 2.x (tools/setup test fetches it)")

# The system's: sets version to 1 or 2; empty where there is none.
function(_quiesce_gpiod_system version)
  find_path(GPIOD_INCLUDE gpiod.h)
  find_library(GPIOD_LIBRARY gpiod)
  mark_as_advanced(GPIOD_INCLUDE GPIOD_LIBRARY)
  set(${version} "" PARENT_SCOPE)
  if(NOT GPIOD_INCLUDE OR NOT GPIOD_LIBRARY)
    return()
  endif()
  file(STRINGS ${GPIOD_INCLUDE}/gpiod.h call REGEX "gpiod_api_version" LIMIT_COUNT 1)
  set(found 1)
  if(call)
    set(found 2)
  endif()
  add_library(gpiod_${found} INTERFACE)
  target_include_directories(gpiod_${found} SYSTEM INTERFACE ${GPIOD_INCLUDE})
  target_link_libraries(gpiod_${found} INTERFACE ${GPIOD_LIBRARY})
  set(${version} ${found} PARENT_SCOPE)
endfunction()

# Version 2 from its sources.
function(_quiesce_gpiod_built)
  file(GLOB sources ${QUIESCE_GPIOD_DIR}/lib/*.c)
  file(STRINGS ${QUIESCE_GPIOD_DIR}/libgpiod-version.txt version LIMIT_COUNT 1)
  add_library(gpiod_2 SHARED ${sources})
  set_target_properties(gpiod_2 PROPERTIES OUTPUT_NAME gpiod SOVERSION 3 C_EXTENSIONS ON
                                           EXPORT_COMPILE_COMMANDS OFF)
  target_compile_definitions(gpiod_2 PRIVATE _GNU_SOURCE GPIOD_API_VERSION_STR="${version}")
  target_compile_options(gpiod_2 PRIVATE -w)
  target_include_directories(gpiod_2 PRIVATE ${QUIESCE_GPIOD_DIR}/lib)
  target_include_directories(gpiod_2 SYSTEM PUBLIC ${QUIESCE_GPIOD_DIR}/include)
endfunction()

_quiesce_gpiod_system(system_version)
if(NOT TARGET gpiod_2 AND EXISTS ${QUIESCE_GPIOD_DIR}/.complete)
  _quiesce_gpiod_built()
endif()
if(NOT system_version AND TARGET gpiod_2)
  set(system_version 2)
endif()

if(NOT QUIESCE_GPIOD)
  set(QUIESCE_GPIOD "${system_version}" CACHE STRING "Version of libgpiod that programs use: 1 or 2" FORCE)
endif()
if(NOT TARGET "gpiod_${QUIESCE_GPIOD}")
  message(FATAL_ERROR
    "libgpiod '${QUIESCE_GPIOD}' not found: install Debian's libgpiod-dev (1.6) or run tools/setup test "
    "(2.x), set QUIESCE_GPIOD to the one that is there (1 or 2), or configure with -DQUIESCE_LINUX=OFF")
endif()
