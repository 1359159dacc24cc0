# The drivers, for images and for tests on the host.
add_library(hal_stm32f4 STATIC EXCLUDE_FROM_ALL
            ${CMAKE_CURRENT_LIST_DIR}/bridge.c ${CMAKE_CURRENT_LIST_DIR}/can_stm32f4.c ${CMAKE_CURRENT_LIST_DIR}/clocks.c ${CMAKE_CURRENT_LIST_DIR}/dac.c ${CMAKE_CURRENT_LIST_DIR}/nvm_stm32f4.c ${CMAKE_CURRENT_LIST_DIR}/pins.c
            ${CMAKE_CURRENT_LIST_DIR}/reset_cause.c ${CMAKE_CURRENT_LIST_DIR}/spi_stm32f4.c ${CMAKE_CURRENT_LIST_DIR}/supply.c ${CMAKE_CURRENT_LIST_DIR}/tick_stm32f4.c
            ${CMAKE_CURRENT_LIST_DIR}/uart_stm32f4.c ${CMAKE_CURRENT_LIST_DIR}/watchdog.c)
target_include_directories(hal_stm32f4 PUBLIC ${CMAKE_CURRENT_LIST_DIR} ${CMAKE_CURRENT_LIST_DIR}/generated
                                              ${CMAKE_CURRENT_LIST_DIR}/../include)
target_include_directories(hal_stm32f4 PUBLIC ${PROJECT_SOURCE_DIR}/firmware/comm) # what a frame is
target_link_libraries(hal_stm32f4 PUBLIC hal_parts PRIVATE quiesce_warnings)
