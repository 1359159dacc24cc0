# One place for the warnings of our own code; here they are errors. In another project that one's
# flags decide.
add_library(quiesce_warnings INTERFACE)
if(QUIESCE_DEVELOP)
  target_compile_options(
    quiesce_warnings
    INTERFACE -Wall -Wextra -Wpedantic -Werror -Wshadow -Wconversion -Wsign-conversion -Wcast-align
              -Wundef -Wdouble-promotion
              $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes>
              $<$<COMPILE_LANGUAGE:C>:-Wmissing-prototypes>
              $<$<COMPILE_LANGUAGE:C>:-Wvla>)
endif()
