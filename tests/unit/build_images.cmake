# cmake -DSOURCE=.. -DBUILD=.. -DUNITY_DIR=.. -P build_images.cmake: the mps2 images in folder BUILD.
execute_process(COMMAND ${CMAKE_COMMAND} --preset mps2 -S ${SOURCE} -B ${BUILD}
                        -DUNITY_DIR=${UNITY_DIR}
                WORKING_DIRECTORY ${SOURCE} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --target quiesce_mps2_shm
                        quiesce_mps2_uart uart_echo count_probe same_bits
                COMMAND_ERROR_IS_FATAL ANY)
