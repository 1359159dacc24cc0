# A board is its file in boards/ and its line here.
quiesce_stm32f4_board(nucleo_f446re)
quiesce_stm32f4_board(olimex_h405)
