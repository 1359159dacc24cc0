# What only builds of this project itself have.
option(QUIESCE_SANITIZE "AddressSanitizer and UndefinedBehaviorSanitizer" OFF)
option(QUIESCE_COVERAGE "Coverage counters for gcovr" OFF)
option(QUIESCE_BENCH "Plant, bench and their tests (C++)" ON)
option(QUIESCE_LINUX "The Linux controller quiesced and its backends" ON)
option(QUIESCE_PROGRAMS "Images of targets/ and of benchmarks; without them: the core and its tests" ON)
option(QUIESCE_TESTS "Examples, tests and what benchmarks measure with" ON)
set(UNITY_DIR "${PROJECT_SOURCE_DIR}/build/deps/unity" CACHE PATH
    "Folder with unity.c, unity.h, unity_internals.h (tools/setup fetches it)")

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

if(QUIESCE_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
if(QUIESCE_COVERAGE)
  add_compile_options(--coverage -O0)
  add_link_options(--coverage)
endif()

enable_testing()
