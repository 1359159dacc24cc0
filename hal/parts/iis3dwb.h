/// The IIS3DWB's registers over any SPI: 16 bits, 26.7 kHz, of which a control tick takes the
/// newest; its low-pass ends at 267 Hz. Source: ST's data sheet DS12569 (register mapping, SPI
/// bus).
#ifndef IIS3DWB_H
#define IIS3DWB_H

#include "hal/accel.h"
#include "part_bus.h"

#define IIS3DWB_AXES 3

typedef struct {
    part_bus_t bus;
    int32_t counts[IIS3DWB_AXES];
    bool is_fresh[IIS3DWB_AXES];
    uint32_t failures; ///< transfers, saturating
} iis3dwb_t;

/// Checks the part, resets and configures it and starts measuring; every setting is read back.
/// Takes some 20 ms. range_g: 2, 4, 8 or 16.
bool iis3dwb_start(iis3dwb_t *self, part_bus_t bus, uint32_t range_g, part_problem_t *problem);

/// As hal_accel_read.
bool iis3dwb_read(iis3dwb_t *self, hal_axis_t axis, int32_t *counts);

#endif
