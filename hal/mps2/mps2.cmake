# Arm's MPS2 boards under QEMU, one FPGA image a processor: mps2-an385 (Cortex-M3), -an386 (M4), -an500
# (M7), -an505 (M33). The drivers are those of an386; images of the others need none.
include(${CMAKE_CURRENT_LIST_DIR}/../cortex_m/cortex_m.cmake)
add_library(hal_mps2 STATIC mps2/nap.c mps2/nvm_mps2.c mps2/tick_mps2.c mps2/uart_mps2.c)
target_include_directories(hal_mps2 PUBLIC mps2 include)
target_link_libraries(hal_mps2 PUBLIC hal_cortex_m PRIVATE quiesce_warnings)
target_link_libraries(hal_nvm INTERFACE hal_mps2) # the memory of its records

# For images that run free: takes the place of fault_exit.c.
add_library(mps2_fault_free OBJECT mps2/fault_free.c)
target_link_libraries(mps2_fault_free PRIVATE hal_cortex_m quiesce_warnings)

set(memory ${CMAKE_CURRENT_LIST_DIR})
if(QUIESCE_MACHINE STREQUAL "mps2-an505")
  string(APPEND memory /an505)
endif()
quiesce_port(${memory} mps2/startup.c)
target_link_libraries(image_startup PUBLIC hal_mps2)
