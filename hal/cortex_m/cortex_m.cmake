# What the boards with a Cortex-M have in common: the fault record, its handler, semihosting.
include(${CMAKE_CURRENT_LIST_DIR}/../image/image.cmake)
add_library(hal_cortex_m STATIC cortex_m/fault.c cortex_m/fault_entry.c cortex_m/fault_exit.c
                                cortex_m/fault_record.c cortex_m/fault_restart.c cortex_m/idle.c cortex_m/processor.c
                                cortex_m/semihost_trap.c)
target_include_directories(hal_cortex_m PUBLIC cortex_m)
target_link_libraries(hal_cortex_m PUBLIC hal_image PRIVATE quiesce_warnings)
target_link_libraries(hal_image INTERFACE hal_cortex_m) # semihost_trap
