// ST's NUCLEO-F446RE (UM1724): the debugger's processor gives the clock and takes the console
// (USART2) to USB.
#include "board.h"
#include "stm32f4_interrupts.h"
#include "stm32f4_spi.h"
#include "stm32f4_usart.h"

const stm32f4_board_t stm32f4_board = {
    .name = "nucleo_f446re",
    .crystal_Hz = 8000000u,
    .crystal_is_external = true,
    .console = USART2_BASE,
    .console_interrupt = USART2_INTERRUPT,
    .console_rx = {PIN_A(3), 7},
    .console_tx = {PIN_A(2), 7},
    .console_baud = 1000000u,
    .estop = PIN_C(0),         // CN7-38, A5
    .enable = PIN_C(1),        // CN7-36, A4
    .acknowledge = PIN_C(13),  // B1, the blue button
    .fault_lamp = PIN_B(5),    // CN10-29, D4
    .drive_enable = PIN_B(10), // CN10-25, D6
    .can = {.rx = PIN_B(8), .tx = PIN_B(9), .bit_rate_Hz = 500000u},
    .accel =
        {
            .part = ACCEL_ADXL355,
            .spi = SPI1_BASE,
            .sck = PIN_A(5),
            .miso = PIN_A(6),
            .mosi = PIN_A(7),
            .select = PIN_B(6),
            .drdy = PIN_C(7),
            .range_g = 2,
        },
    .output = OUTPUT_BRIDGE,
    // Current: 2.5 V at none, 100 mV/A, halved to 3.3 V: 62 counts/A. Supply: 10 k over 1 k.
    .bridge =
        {
            .pwm = PIN_A(8),
            .cut_off = PIN_B(12),
            .current = PIN_A(0),
            .supply = PIN_A(1),
            .current_channel = 0,
            .supply_channel = 1,
            .current_zero_counts = 1551,
            .current_uA_a_count = 16000,
            .supply_uV_a_count = 8865,
        },
    .loop =
        {
            .resistance_mohm = 5000,
            .gain_mV_a_mA_q8 = 12800,
            .integral_time_us = 20000,
            .integral_mV = 8000,
            .least_duty = 0,
            .full_scale_mA = 5000,
        },
};
