/// What is wired to what: sensors, bodies, dampers, and the limits that no message, parameter or
/// table can raise. Checked once, at the start; `quiesce board compile` makes one from a file.
///
/// Plain words of one layout in every build, so that one board serves host, images and Linux.
#ifndef QUIESCE_BOARD_H
#define QUIESCE_BOARD_H

#include <stdbool.h>
#include <stdint.h>

#include "quiesce_size.h"

#ifdef __cplusplus
extern "C" {
#endif

/// The end of a damper that does not move.
#define QUIESCE_GROUND 255

/// No driver that we know takes more; it also keeps uA inside 32 bits.
#define QUIESCE_HIGHEST_CURRENT_mA 20000

/// What a sensor measures, in the unit of its samples after scaling.
typedef enum {
    QUIESCE_SENSE_ACCEL = 0,           ///< of a body, um/s2
    QUIESCE_SENSE_VELOCITY = 1,        ///< of a body, um/s
    QUIESCE_SENSE_DISPLACEMENT = 2,    ///< of a body, nm
    QUIESCE_SENSE_STROKE = 3,          ///< of a damper between its ends, nm
    QUIESCE_SENSE_STROKE_VELOCITY = 4, ///< of a damper, um/s
    QUIESCE_SENSE_FORCE = 5,           ///< of a damper, mN, > 0 resists a stroke that grows
    QUIESCE_SENSE_VOLTAGE = 6,         ///< across a damper's coil, mV
    QUIESCE_SENSE_TEMPERATURE = 7,     ///< of a damper, mdegC
    QUIESCE_SENSE_SUPPLY = 8,          ///< of the drivers, mV
    QUIESCE_SENSES
} quiesce_sense_t;

/// Whether a sensor of that is on a body; else on a damper, or the board's.
static inline bool quiesce_sense_is_of_body(int32_t sense) {
    return sense <= QUIESCE_SENSE_DISPLACEMENT;
}

typedef struct {
    int32_t sense;         ///< quiesce_sense_t
    int32_t at;            ///< body or damper, from 0; 0 for the supply
    int32_t axis;          ///< of an accelerometer: 0 x, 1 y, 2 z
    int32_t polarity;      ///< -1 or 1, against the structure's positive direction
    int32_t scale;         ///< thousandths of the unit a count, 1 .. 10^9
    int32_t offset_counts; ///< at zero
    int32_t
        full_scale_counts;    ///< largest magnitude that it can report; at it a sample is saturated
    int32_t period_us;        ///< between samples; 0: one a tick
    int32_t max_age_us;       ///< longest hold of the last good sample
    int32_t stuck_us;         ///< identical samples for so long are a fault; 0: no check
    int32_t min_noise_counts; ///< less (RMS, over a second) is a fault; 0: no check
    int32_t max_lost_pct; ///< of the last 256 samples; more lost ones are a fault; 100: no check
    int32_t latency_us;   ///< from the motion to the sample
    int32_t corner_mHz;   ///< of an accelerometer: first-order high-pass, -3 dB, its phases lead by
                          ///< atan(corner / f); 0: none
} quiesce_board_sensor_t;

typedef struct {
    int32_t end_a;         ///< body
    int32_t end_b;         ///< body or QUIESCE_GROUND; the stroke is a - b
    int32_t ceiling_mA;    ///< no command is above it, whatever parameters say
    int32_t safe_mA;       ///< where it is when nothing is commanded, <= ceiling_mA
    int32_t continuous_mA; ///< that coil and driver carry for ever, a tenth of ceiling_mA up to it
    int32_t heat_s;        ///< time constant of the coil's heat
    int32_t trip_mA;       ///< measured above it for trip_us: driver off; 0: no trip
    int32_t trip_us;
    int32_t measures_current; ///< 1: the driver says what flows
    int32_t coil_lag_us;      ///< time constant of the current behind its command
    int32_t coil_mohm; ///< resistance, with a sensor of its voltage: a short is seen; 0: not known
} quiesce_board_damper_t;

typedef struct {
    int32_t sensors;        ///< in use, 1 .. QUIESCE_SENSORS
    int32_t bodies;         ///< 1 .. QUIESCE_BODIES
    int32_t dampers;        ///< 1 .. QUIESCE_DAMPERS
    int32_t tracked;        ///< accelerometer whose frequency, RMS and lock laws see
    int32_t bus_latency_us; ///< from the command to the driver
    quiesce_board_sensor_t sensor[QUIESCE_MAX_SENSORS];
    quiesce_board_damper_t damper[QUIESCE_MAX_DAMPERS];
} quiesce_board_t;

/// One accelerometer (24 bit, 49.4 g) on one body, one damper between it and the ground, 5 A.
void quiesce_board_default(quiesce_board_t *board);

/// Why a board was refused.
typedef struct {
    const char *part;   ///< "board", "sensor" or "damper"
    int32_t number;     ///< of the sensor or damper, from 0
    const char *name;   ///< of the field
    const char *reason; ///< what is wrong, in words
    int32_t min, max;   ///< what is allowed, where it is out of range; else 0
} quiesce_board_error_t;

/// Returns false iff a value is outside its range, two contradict each other, or the build is too
/// small for it; *error then says which. error may be NULL.
bool quiesce_board_check(const quiesce_board_t *board, quiesce_board_error_t *error);

#ifdef __cplusplus
}
#endif

#endif
