/// A current as a whole number of a driver's steps.
#ifndef CURRENT_SCALE_H
#define CURRENT_SCALE_H

#include <stdint.h>

/// zero + (full - zero) x current / full_scale, to the nearest, halves away from zero; the current
/// is limited to 0 .. full_scale first. full_scale_mA: at least 1.
static inline int64_t current_scale(int32_t current_mA, int32_t full_scale_mA, int64_t zero,
                                    int64_t full) {
    const int64_t limited_mA = current_mA < 0               ? 0
                               : current_mA > full_scale_mA ? full_scale_mA
                                                            : current_mA;
    const int64_t scaled = (full - zero) * limited_mA;
    const int64_t half = scaled < 0 ? -(full_scale_mA / 2) : full_scale_mA / 2;
    return zero + (scaled + half) / full_scale_mA;
}

#endif
