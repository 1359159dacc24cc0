# Backend for mps2-an386 (Cortex-M4 under QEMU) and its images.
add_library(hal_mps2 STATIC mps2/fault.c mps2/fault_exit.c mps2/nap.c mps2/nvm_mps2.c mps2/semihost.c
            mps2/stack.c mps2/tick_mps2.c mps2/uart_mps2.c)
target_include_directories(hal_mps2 PUBLIC mps2 include)
target_compile_definitions(hal_mps2 PUBLIC QUIESCE_TARGET_MPS2)
target_link_libraries(hal_mps2 PRIVATE quiesce_warnings)
target_link_libraries(hal_nvm INTERFACE hal_mps2) # the memory of its records

# For images that run free: takes the place of fault_exit.c.
add_library(mps2_fault_restart OBJECT mps2/fault_restart.c)
target_include_directories(mps2_fault_restart PRIVATE mps2)
target_link_libraries(mps2_fault_restart PRIVATE quiesce_warnings)

# Start-up is linked as objects: nothing refers to the vectors.
add_library(mps2_startup OBJECT mps2/startup.c)
target_link_libraries(mps2_startup PRIVATE hal_mps2 quiesce_warnings)

# Turns an executable into an image: our start-up and memory map; of libc only what is referred to
# (memcpy and its like).
function(quiesce_mps2_image target)
  set(script ${PROJECT_SOURCE_DIR}/hal/mps2/mps2.ld)
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:mps2_startup>)
  target_link_options(${target} PRIVATE -nostdlib -static -T${script} -Wl,--gc-sections
                      -Wl,--fatal-warnings -Wl,-Map=$<TARGET_FILE:${target}>.map)
  target_link_libraries(${target} PRIVATE hal_mps2)
  set_target_properties(${target} PROPERTIES LINK_DEPENDS ${script} SUFFIX .elf)
endfunction()
