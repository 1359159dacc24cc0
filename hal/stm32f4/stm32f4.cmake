# STM32F405 and F446. The drivers alone stand in hal_stm32f4, which tests on the host link, too, with
# fakes in the place of registers (reg.h).
include(${CMAKE_CURRENT_LIST_DIR}/../cortex_m/cortex_m.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/drivers.cmake)
target_link_libraries(hal_stm32f4 PUBLIC hal_cortex_m)
quiesce_port(${CMAKE_CURRENT_LIST_DIR} stm32f4/startup.c)
target_link_libraries(image_startup PUBLIC hal_stm32f4)
target_link_libraries(hal_nvm INTERFACE hal_stm32f4) # the memory of its records
