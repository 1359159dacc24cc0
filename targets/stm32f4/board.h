/// What a board is: its crystal, its console, its pins. One file a board in
/// targets/stm32f4/boards/, which defines stm32f4_board.
#ifndef BOARD_H
#define BOARD_H

#include "bridge.h"
#include "can_stm32f4.h"
#include "current_loop.h"
#include "pins.h"
#include "spi_stm32f4.h"

typedef enum {
    OUTPUT_NONE = 0, ///< the demand goes out on the bus alone
    OUTPUT_BRIDGE,   ///< PWM and the current loop
    OUTPUT_DAC,      ///< a voltage for an external driver
} board_output_t;

typedef struct {
    uint8_t pin;
    uint8_t function; ///< 0 .. 15, of the data sheet's table
} board_pin_t;

typedef struct {
    const char *name;           ///< as in boards.cmake
    uint32_t crystal_Hz;        ///< 0: none
    bool crystal_is_external;   ///< a signal of another chip
    uint32_t console;           ///< USART1_BASE .. USART3_BASE
    uint32_t console_interrupt; ///< its number
    bool console_is_apb2;
    board_pin_t console_rx;
    board_pin_t console_tx;
    uint32_t console_baud;
    uint8_t estop;        ///< a contact to ground that opens in an emergency: high stops
    uint8_t enable;       ///< a switch to ground: low enables; PIN_NONE: the bus alone does
    uint8_t acknowledge;  ///< a button to ground: low acknowledges a latched fault
    uint8_t fault_lamp;   ///< high: a fault, or not started yet
    uint8_t drive_enable; ///< high: the driver may drive; a pull-down holds it where nothing runs
    can_wiring_t can;     ///< beside the console; bit rate 0: none
    accel_wiring_t accel; ///< ACCEL_NONE: samples come from the bus
    board_output_t output;
    bridge_wiring_t bridge;
    current_loop_cfg_t loop; ///< of the bridge; full scale by the coil: 8 times the supply at most,
                             ///< else a little current looks like an open coil
    int32_t dac_full_scale_mA; ///< at the DAC's full scale
} stm32f4_board_t;

extern const stm32f4_board_t stm32f4_board;

#endif
