# The parts of the program, and its lock-step server against the simulated one.
if(CMAKE_CROSSCOMPILING)
  return()
endif()
find_package(GTest REQUIRED)
include(GoogleTest)

add_executable(
  test_quiesced
  quiesced/test_board_fit.cpp
  quiesced/test_bus_load.cpp
  quiesced/test_bus_watch.cpp
  quiesced/test_config.cpp
  quiesced/test_edge_rate.cpp
  quiesced/test_fault.cpp
  quiesced/test_frame_sender.cpp
  quiesced/test_handover.cpp
  quiesced/test_log.cpp
  quiesced/test_loop.cpp
  quiesced/test_lost_ticks.cpp
  quiesced/test_make_safe.cpp
  quiesced/test_notify.cpp
  quiesced/test_options.cpp
  quiesced/test_record.cpp
  quiesced/test_state.cpp
  quiesced/test_tables.cpp
  quiesced/test_tick_source.cpp
  quiesced/test_wiring.cpp
  quiesced/test_wiring_safe.cpp
  quiesced/two_storeys.cpp)
target_link_libraries(test_quiesced PRIVATE can_make quiesced_core quiesce_warnings GTest::gtest_main)
target_include_directories(test_quiesced PRIVATE quiesced ../support)
target_compile_definitions(
  test_quiesced PRIVATE QUIESCED_EXAMPLE="${PROJECT_SOURCE_DIR}/targets/linux/packaging/quiesced.toml")
gtest_discover_tests(test_quiesced TEST_PREFIX quiesced. DISCOVERY_MODE PRE_TEST)

add_executable(test_quiesced_lockstep quiesced/test_lockstep.cpp)
target_link_libraries(test_quiesced_lockstep PRIVATE lockstep_can quiesce_warnings GTest::gtest_main)
add_dependencies(test_quiesced_lockstep quiesced)
target_compile_definitions(test_quiesced_lockstep
                           PRIVATE QUIESCED_PROGRAM="$<TARGET_FILE:quiesced>")
gtest_discover_tests(test_quiesced_lockstep TEST_PREFIX quiesced. DISCOVERY_MODE PRE_TEST)
