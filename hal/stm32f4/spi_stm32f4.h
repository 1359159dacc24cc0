/// part_bus.h on SPI1 or SPI2: mode 0, the chip select a pin; and hal/accel.h on it, for the part
/// that a board has. Untested on silicon; what to measure: docs/howto/stm32f4.md.
#ifndef SPI_STM32F4_H
#define SPI_STM32F4_H

#include "adxl355.h"
#include "iis3dwb.h"
#include "pins.h"

typedef enum { ACCEL_NONE = 0, ACCEL_ADXL355, ACCEL_IIS3DWB } accel_part_t;

/// What a board wires. drdy: the ADXL355's data-ready line, high where a sample waits; PIN_NONE:
/// the part is asked in every tick.
typedef struct {
    accel_part_t part;
    uint32_t spi; ///< SPI1_BASE or SPI2_BASE
    uint8_t sck, miso, mosi, select, drdy;
    uint32_t range_g;
} accel_wiring_t;

struct hal_accel {
    accel_wiring_t wiring;
    part_problem_t problem; ///< of the start
    bool is_started;
    bool is_adxl355; ///< has started once
    uint32_t rate_Hz;
    adxl355_t adxl355; ///< the one of them that is wired
    iis3dwb_t iis3dwb;
};

/// bus_Hz: the clock of the SPI's bus. core_Hz: for the pauses of a part's start. Some 10 ms.
/// An ADXL355 then measures at 1000 Hz. Returns false, with the reason in accel->problem, iff the
/// part does not start; reads then have no sample.
bool accel_stm32f4_open(hal_accel_t *accel, const accel_wiring_t *wiring, uint32_t bus_Hz,
                        uint32_t core_Hz);

/// The rate of a part that has started; the IIS3DWB has one for all. Returns false, and reads have
/// no sample, where it has no such rate or does not answer; another call may make it well.
bool accel_stm32f4_set_rate(hal_accel_t *accel, uint32_t rate_Hz);

#endif
