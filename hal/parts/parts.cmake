# Sensors over any SPI (part_bus.h), for Linux and for boards.
add_library(hal_parts STATIC EXCLUDE_FROM_ALL ${CMAKE_CURRENT_LIST_DIR}/adxl355.c
                                              ${CMAKE_CURRENT_LIST_DIR}/iis3dwb.c
                                              ${CMAKE_CURRENT_LIST_DIR}/part_bus.c)
target_include_directories(hal_parts PUBLIC ${CMAKE_CURRENT_LIST_DIR} ${CMAKE_CURRENT_LIST_DIR}/../include)
target_link_libraries(hal_parts PRIVATE quiesce_warnings)
