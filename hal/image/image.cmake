# Images under an emulator: what all ports of the firmware have in common. A port is a folder beside
# this one, QUIESCE_HAL, with
#   PORT.cmake  includes this file and says what its start-up is: quiesce_port(SOURCE ...)
#   startup.c   Reset_Handler and semihost_trap
#   memory.ld   or MACHINE/memory.ld: the two memories of the machine, QUIESCE_MACHINE
set(QUIESCE_STACK_BYTES 16384 CACHE STRING "Stack of an image, bytes; a multiple of 8")

add_library(hal_image STATIC ${CMAKE_CURRENT_LIST_DIR}/semihost.c ${CMAKE_CURRENT_LIST_DIR}/stack.c
                             ${CMAKE_CURRENT_LIST_DIR}/start.c
                             ${CMAKE_CURRENT_LIST_DIR}/image_info.c ${CMAKE_CURRENT_LIST_DIR}/image_place.c
                             ${CMAKE_CURRENT_LIST_DIR}/sha256.c)
target_include_directories(hal_image PUBLIC ${CMAKE_CURRENT_LIST_DIR})
set_source_files_properties(${CMAKE_CURRENT_LIST_DIR}/image_info.c ${CMAKE_CURRENT_LIST_DIR}/image_place.c ${CMAKE_CURRENT_LIST_DIR}/sha256.c
                            PROPERTIES COMPILE_OPTIONS -Os) # once, at the start
target_compile_definitions(hal_image PUBLIC QUIESCE_TARGET_IMAGE)
target_link_libraries(hal_image PRIVATE quiesce_warnings)

# quiesce_port(MEMORY SOURCE...): start-up, linked as objects since nothing refers to it; MEMORY is the
# folder of memory.ld.
function(quiesce_port memory)
  add_library(image_startup OBJECT ${ARGN})
  target_link_libraries(image_startup PUBLIC hal_image PRIVATE quiesce_warnings)
  set_target_properties(image_startup PROPERTIES IMAGE_MEMORY ${memory})
endfunction()

# quiesce_image(TARGET): turns an executable into an image: the port's start-up and memory map; of
# libc only what is referred to (memcpy and its like).
function(quiesce_image target)
  set(script ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/image.ld)
  get_target_property(memory image_startup IMAGE_MEMORY)
  target_link_options(${target} PRIVATE -nostdlib -static -T${script} -L${memory} -Wl,--gc-sections
                      -Wl,--defsym=stack_bytes=${QUIESCE_STACK_BYTES} -Wl,--fatal-warnings
                      -Wl,-Map=$<TARGET_FILE:${target}>.map)
  target_link_libraries(${target} PRIVATE image_startup)
  set_target_properties(${target} PROPERTIES LINK_DEPENDS "${script};${memory}/memory.ld"
                                             SUFFIX .elf)
endfunction()
