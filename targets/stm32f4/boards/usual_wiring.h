/// What boards with a connector for nearly every pin have alike: CAN, sensor, bridge, coil. A board
/// that is wired otherwise names its own instead.
#ifndef USUAL_WIRING_H
#define USUAL_WIRING_H

#include "board.h"
#include "stm32f4_spi.h"

// Current: 2.5 V at none, 100 mV/A, halved to 3.3 V: 62 counts/A. Supply: 10 k over 1 k.
// clang-format off
#define USUAL_WIRING \
    .can = {.rx = PIN_B(8), .tx = PIN_B(9), .bit_rate_Hz = 500000u}, \
    .accel = \
        { \
            .part = ACCEL_ADXL355, \
            .spi = SPI1_BASE, \
            .sck = PIN_A(5), \
            .miso = PIN_A(6), \
            .mosi = PIN_A(7), \
            .select = PIN_B(6), \
            .drdy = PIN_C(7), \
            .range_g = 2, \
        }, \
    .output = OUTPUT_BRIDGE, \
    .bridge = \
        { \
            .pwm = PIN_A(8), \
            .cut_off = PIN_B(12), \
            .current = PIN_A(0), \
            .supply = PIN_A(1), \
            .current_channel = 0, \
            .supply_channel = 1, \
            .current_zero_counts = 1551, \
            .current_uA_a_count = 16000, \
            .supply_uV_a_count = 8865, \
        }, \
    .loop = \
        { \
            .resistance_mohm = 5000, \
            .gain_mV_a_mA_q8 = 12800, \
            .integral_time_us = 20000, \
            .integral_mV = 8000, \
            .least_duty = 0, \
            .full_scale_mA = 5000, \
        }
// clang-format on

#endif
