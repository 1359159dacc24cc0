# Cross compiler for 64-bit ARM Linux (Debian: g++-aarch64-linux-gnu). Headers and libraries beyond
# those of C and C++ come from the Debian arm64 packages that `tests/system/vm/build_images root` unpacks; nothing
# is taken from this machine's own folders.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

set(QUIESCE_ARM64_ROOT "${CMAKE_CURRENT_LIST_DIR}/../build/deps/arm64" CACHE PATH
    "Folder with Debian's arm64 packages, unpacked")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES QUIESCE_ARM64_ROOT)
set(CMAKE_FIND_ROOT_PATH "${QUIESCE_ARM64_ROOT}" /usr/aarch64-linux-gnu)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} "${QUIESCE_ARM64_ROOT}")
set(ENV{PKG_CONFIG_LIBDIR}
    "${QUIESCE_ARM64_ROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${QUIESCE_ARM64_ROOT}/usr/share/pkgconfig")

# Unit tests run in QEMU's user mode, where it is installed, with the unpacked libraries.
find_program(QEMU_AARCH64 NAMES qemu-aarch64 qemu-aarch64-static)
if(QEMU_AARCH64)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${QEMU_AARCH64};-L;${QUIESCE_ARM64_ROOT}")
endif()
