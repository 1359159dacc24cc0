/// The ADXL355's registers over any SPI. Source: Analog Devices' data sheet ADXL354/ADXL355, Rev. C
/// (register map; SPI protocol).
#ifndef ADXL355_H
#define ADXL355_H

#include "hal/accel.h"
#include "part_bus.h"

#define ADXL355_AXES 3
#define ADXL355_MAX_TRANSFER 14u ///< bytes: a command and the registers from STATUS to ZDATA1

typedef struct {
    part_bus_t bus;
    int32_t counts[ADXL355_AXES];
    bool is_fresh[ADXL355_AXES];
    uint32_t failures; ///< transfers, saturating
} adxl355_t;

/// Checks the part, resets and configures it and starts measuring; every setting is read back.
/// Takes some ms. range_g: 2, 4 or 8; rate_Hz: 4000, 2000, 1000 or 500.
bool adxl355_start(adxl355_t *self, part_bus_t bus, uint32_t range_g, uint32_t rate_Hz,
                   part_problem_t *problem);

/// Another rate of a part that has been started, within some 100 us. Returns false where it has no
/// such rate, and measures on at the old one, or where the transfer failed.
bool adxl355_set_rate(adxl355_t *self, uint32_t rate_Hz, part_problem_t *problem);

/// As hal_accel_read.
bool adxl355_read(adxl355_t *self, hal_axis_t axis, int32_t *counts);

/// Back to standby. Returns false where the transfer failed.
bool adxl355_stop(adxl355_t *self);

#endif
