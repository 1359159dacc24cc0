# cmake -DPROGRAM=.. -DIMAGE=.. -P same_bits.cmake: the program and the image under the emulator must
# print the same, a line a case.
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE native COMMAND_ERROR_IS_FATAL ANY)
execute_process(
  COMMAND qemu-system-arm -M mps2-an386 -display none -monitor none -serial none
          -semihosting-config enable=on,target=native -kernel ${IMAGE}
  OUTPUT_VARIABLE emulated
  ERROR_VARIABLE emulated_too # where the emulator sends the image's text
  COMMAND_ERROR_IS_FATAL ANY)
string(APPEND emulated "${emulated_too}")
string(REGEX MATCHALL "[0-9A-F]+ [0-9A-F]+\n" lines "${native}")
list(LENGTH lines count)
list(REMOVE_DUPLICATES lines)
list(LENGTH lines distinct)
if(count LESS 24 OR distinct LESS count)
  message(FATAL_ERROR "expected 24 different lines:\n${native}")
endif()
if(NOT native STREQUAL emulated)
  message(FATAL_ERROR "this build:\n${native}\nthe image:\n${emulated}")
endif()
