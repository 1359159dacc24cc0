/// Pulses over frequency: when, within half a cycle of the vibration, current flows. A table of
/// 32-bit words, made by `quiesce tune`; phase_table_check says whether it can be trusted.
///
/// Phases are those of the displacement's fundamental, x = X cos(psi); the current repeats after
/// half a cycle, so they are told modulo half a turn, in half turns Q16 (65536 is 180 degrees).
/// They are phases of the command: it leads the coil's lag already.
#ifndef PHASE_TABLE_H
#define PHASE_TABLE_H

#include "fixq.h"
#include "table.h"

#define PHASE_TABLE_MAGIC UINT32_C(0x31485051)
#define PHASE_TABLE_SETTINGS 2u
#define PHASE_TABLE_MIN_POINTS 2u
#define PHASE_TABLE_MAX_POINTS 64u
#define PHASE_TABLE_HEADER_WORDS 5u
#define PHASE_TABLE_MAX_WORDS                                                                      \
    (PHASE_TABLE_HEADER_WORDS + 4u * PHASE_TABLE_SETTINGS * PHASE_TABLE_MAX_POINTS)
#define PHASE_WIDTH_ALL 65535u ///< no gap: one current throughout

typedef struct {
    uint16_t freq_mHz;
    uint16_t level_mA;
    uint16_t centre_q16;
    uint16_t width_q16;
    uint16_t floor_mA;        ///< between pulses, <= level_mA
    uint16_t accel_weight_q8; ///< for adapt.h: what acceleration counts against displacement ..
    uint16_t accel_shape_q14; ///< .. beyond this ratio of the two
    uint16_t ramp_q16;        ///< how long an edge takes, about its middle; 0: at once
} phase_point_t;

typedef struct {
    uint32_t magic;
    uint32_t crc; ///< of all words after it
    uint32_t words;
    uint16_t points[PHASE_TABLE_SETTINGS];
    uint32_t unlock_current_mA; ///< best constant current of the plant that it was made for
    phase_point_t point[];      ///< of the first setting, then of the next one, rising freq_mHz
} phase_table_t;

/// Of words with a good head. SHAPE: numbers of points; POINT: frequencies that do not rise, a
/// floor above its level, a ramp too long. Nothing else reads a table that has not passed.
quiesce_table_verdict_t phase_table_check(const uint32_t *words);

/// Points of a setting.
const phase_point_t *phase_table_points(const phase_table_t *table, uint32_t setting);

/// Where a frequency lies between two points.
typedef struct {
    uint32_t index;    ///< of the point below it, 0 .. points - 2
    uint32_t part_q16; ///< of the way to the next one, 0 .. 65536
} phase_place_t;

/// Place of a frequency among count points, at an end where it lies beyond. last_index, 0 .. count
/// - 2: where it was last time, looked at first. At most 9 comparisons and a division.
phase_place_t phase_place(const phase_point_t *points, uint32_t count, uint32_t freq_mHz,
                          uint32_t last_index);

/// A pulse: on from its first edge to its last one.
typedef struct {
    uint32_t width_q16;
    int32_t level_mA;
    int32_t floor_mA;
    uint16_t on_q16;
    uint16_t ramp_q16; ///< of an edge, about its middle
    uint16_t accel_weight_q8;
    uint16_t accel_shape_q14;
} phase_pulse_t;

/// Linear between the two points; the centre the shorter way round.
phase_pulse_t phase_pulse_at(const phase_point_t *points, phase_place_t place);

/// Mean current of a pulse over the phases from start_turn, length_turn long (half turns Q32,
/// 0 < length < 2^31), mA.
int32_t phase_pulse_current_mA(const phase_pulse_t *pulse, uint32_t start_turn,
                               uint32_t length_turn);

#endif
