# A 32-bit RISC-V under QEMU (machine virt): for tests of the firmware; it has no drivers.
include(${CMAKE_CURRENT_LIST_DIR}/../image/image.cmake)
quiesce_port(${CMAKE_CURRENT_LIST_DIR} riscv_virt/startup.c)
