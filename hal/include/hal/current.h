/// Coil current driver: one command a control tick, an optional measurement back.
#ifndef HAL_CURRENT_H
#define HAL_CURRENT_H

#include <stdbool.h>
#include <stdint.h>

typedef struct hal_current hal_current_t;

/// Command the coil current. Call once a tick.
/// current_mA: 0 .. the driver's full scale; the backend rounds to its own resolution.
/// enable: false switches the driver's output stage off, whatever the current.
void hal_current_write(hal_current_t *driver, int32_t current_mA, bool enable);

/// Measured coil current in mA; written only where the function returns true.
/// Returns false iff the driver has no measurement.
bool hal_current_read(hal_current_t *driver, int32_t *current_mA);

#endif
