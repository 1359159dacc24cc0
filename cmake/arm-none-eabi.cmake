# Cross compiler for bare-metal Cortex-M (Debian: gcc-arm-none-eabi, libnewlib-arm-none-eabi). The M4
# without its floating-point unit, unless a preset names another one.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(QUIESCE_CPU "-mcpu=cortex-m4 -mfloat-abi=soft" CACHE STRING "The processor, as the compiler's flags")
set(QUIESCE_HAL mps2 CACHE STRING "Folder of hal/ that images are linked with")
set(QUIESCE_MACHINE mps2-an386 CACHE STRING "Machine of QEMU that images run on")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES QUIESCE_CPU QUIESCE_MACHINE)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_C_FLAGS_INIT "${QUIESCE_CPU} -mthumb -ffreestanding -ffunction-sections -fdata-sections")
# Not the _INIT variable: CMake would append its own -O3 to that.
set(CMAKE_C_FLAGS_RELEASE "-O3 -DNDEBUG" CACHE STRING "Flags of the release image")
# Images link with -nostdlib; these come last, for memcpy and its like.
set(CMAKE_C_STANDARD_LIBRARIES_INIT "-lc -lgcc")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)

# An image under it ends with main's result.
set(CMAKE_CROSSCOMPILING_EMULATOR
    qemu-system-arm -M ${QUIESCE_MACHINE} -display none -monitor none -serial none
    -semihosting-config enable=on,target=native -kernel)
