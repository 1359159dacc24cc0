# Cross compiler for bare-metal 32-bit RISC-V (Debian: gcc-riscv64-unknown-elf,
# picolibc-riscv64-unknown-elf, qemu-system-misc).
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR riscv32)
set(QUIESCE_HAL riscv_virt CACHE STRING "Folder of hal/ that images are linked with")
set(CMAKE_C_COMPILER riscv64-unknown-elf-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_C_FLAGS_INIT "-march=rv32imac -mabi=ilp32 -mcmodel=medany --specs=picolibc.specs \
-ffreestanding -ffunction-sections -fdata-sections")
# Not the _INIT variable: CMake would append its own -O3 to that.
set(CMAKE_C_FLAGS_RELEASE "-O3 -DNDEBUG" CACHE STRING "Flags of the release image")
# Images link with -nostdlib; these come last, for memcpy and its like.
set(CMAKE_C_STANDARD_LIBRARIES_INIT "-lc -lgcc")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)

# An image under it ends with main's result.
set(CMAKE_CROSSCOMPILING_EMULATOR
    qemu-system-riscv32 -M virt -bios none -display none -monitor none -serial none
    -semihosting-config enable=on,target=native -kernel)
