# cmake -DPROGRAM=.. -DRECORDED=.. -P streams.cmake: the program prints the recorded streams.
# QEMU sends an image's text to its standard error.
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE found ERROR_VARIABLE found COMMAND_ERROR_IS_FATAL ANY)
file(STRINGS ${RECORDED} recorded REGEX "^(columns|streams/|guards/)")
string(REGEX REPLACE "\n$" "" found "${found}")
string(REPLACE "\n" ";" found "${found}")
foreach(recorded_line found_line IN ZIP_LISTS recorded found)
  if(NOT recorded_line STREQUAL found_line)
    message(FATAL_ERROR "recorded:\n${recorded_line}\nfound:\n${found_line}\n"
                        "`./tools/golden check` tells more")
  endif()
endforeach()
