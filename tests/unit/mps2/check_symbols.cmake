# cmake -DNM=.. -DIMAGE=.. -P check_symbols.cmake: fails where the image has a symbol of software
# floating point, of the heap or of formatted output.
execute_process(COMMAND ${NM} ${IMAGE} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
if(NOT symbols MATCHES " Reset_Handler\n")
  message(FATAL_ERROR "${IMAGE}: has no symbols to check")
endif()
set(forbidden " (__aeabi_[fd][0-9a-z_]*|__aeabi_[a-z]+2[fd]|__[a-z]+[sd]f[0-9]?|_*(malloc|calloc|realloc|free|sbrk)(_r)?|_*[a-z]*printf(_r)?)\n")
string(REGEX MATCHALL "${forbidden}" found "${symbols}")
if(found)
  message(FATAL_ERROR "${IMAGE}: has symbols that firmware must not need: ${found}")
endif()
