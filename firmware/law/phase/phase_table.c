#include "phase_table.h"

#include <stddef.h>

enum { POINT_WORDS = 4, LONGEST_RAMP_q16 = 32767 };

_Static_assert(sizeof(phase_point_t) == 4u * POINT_WORDS, "words on the wire");
_Static_assert(offsetof(phase_table_t, point) == 4u * PHASE_TABLE_HEADER_WORDS,
               "words on the wire");

static bool are_points_good(const phase_point_t *points, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        if (points[i].floor_mA > points[i].level_mA || points[i].ramp_q16 > LONGEST_RAMP_q16 ||
            (i > 0 && points[i].freq_mHz <= points[i - 1u].freq_mHz)) {
            return false;
        }
    }
    return true;
}

static bool has_shape(const phase_table_t *table) {
    uint32_t points = 0;
    for (uint32_t i = 0; i < PHASE_TABLE_SETTINGS; i++) {
        if (table->points[i] < PHASE_TABLE_MIN_POINTS ||
            table->points[i] > PHASE_TABLE_MAX_POINTS) {
            return false;
        }
        points += table->points[i];
    }
    return table->words == PHASE_TABLE_HEADER_WORDS + POINT_WORDS * points;
}

quiesce_table_verdict_t phase_table_check(const uint32_t *words) {
    const phase_table_t *table = (const phase_table_t *)(const void *)words;
    if (!has_shape(table)) {
        return QUIESCE_TABLE_SHAPE;
    }
    for (uint32_t i = 0; i < PHASE_TABLE_SETTINGS; i++) {
        if (!are_points_good(phase_table_points(table, i), table->points[i])) {
            return QUIESCE_TABLE_POINT;
        }
    }
    return QUIESCE_TABLE_OK;
}

const phase_point_t *phase_table_points(const phase_table_t *table, uint32_t setting) {
    return &table->point[setting == 0 ? 0 : table->points[0]];
}

static uint32_t index_below(const phase_point_t *points, uint32_t count, uint32_t freq_mHz) {
    uint32_t low = 0;
    uint32_t high = count - 1u;
    while (high - low > 1u) {
        const uint32_t middle = (low + high) / 2u;
        if (points[middle].freq_mHz <= freq_mHz) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

phase_place_t phase_place(const phase_point_t *points, uint32_t count, uint32_t freq_mHz,
                          uint32_t last_index) {
    const phase_point_t *last = &points[last_index];
    const bool is_same = freq_mHz >= last[0].freq_mHz && freq_mHz < last[1].freq_mHz;
    const uint32_t index = is_same ? last_index : index_below(points, count, freq_mHz);
    const uint32_t below = points[index].freq_mHz;
    const uint32_t above = points[index + 1u].freq_mHz;
    if (freq_mHz <= below) {
        return (phase_place_t){index, 0};
    }
    if (freq_mHz >= above) {
        return (phase_place_t){index, 65536};
    }
    return (phase_place_t){index, ((freq_mHz - below) << 16) / (above - below)};
}

static uint32_t between(uint32_t from, int32_t change, uint32_t part_q16) {
    return from + (uint32_t)(int32_t)(((int64_t)change * part_q16) >> 16);
}

static uint16_t between_u16(uint16_t from, uint16_t to, uint32_t part_q16) {
    return (uint16_t)between(from, to - from, part_q16);
}

phase_pulse_t phase_pulse_at(const phase_point_t *points, phase_place_t place) {
    const phase_point_t *a = &points[place.index];
    const phase_point_t *b = &points[place.index + 1u];
    const uint32_t part = place.part_q16;
    // As 16 bits the difference is the shorter way round.
    const int32_t turn = (int16_t)(uint16_t)(b->centre_q16 - a->centre_q16);
    const uint32_t centre_q16 = between(a->centre_q16, turn, part);
    const uint32_t width_q16 = between(a->width_q16, b->width_q16 - a->width_q16, part);
    return (phase_pulse_t){
        .width_q16 = width_q16,
        .level_mA = (int32_t)between(a->level_mA, b->level_mA - a->level_mA, part),
        .floor_mA = (int32_t)between(a->floor_mA, b->floor_mA - a->floor_mA, part),
        .on_q16 = (uint16_t)(centre_q16 - width_q16 / 2u),
        .ramp_q16 = between_u16(a->ramp_q16, b->ramp_q16, part),
        .accel_weight_q8 = between_u16(a->accel_weight_q8, b->accel_weight_q8, part),
        .accel_shape_q14 = between_u16(a->accel_shape_q14, b->accel_shape_q14, part),
    };
}

static uint32_t least_u32(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

// How much of start .. start + length lies in 0 .. width, circular over 2^32.
static uint32_t covered(uint32_t start, uint32_t length, uint32_t width) {
    const uint32_t end = start + length; // of the next turn where it is below start
    const uint32_t first = start < width ? least_u32(length, width - start) : 0;
    return first + (end < start ? least_u32(end, width) : 0);
}

// Ramps never overlap.
static uint32_t ramp_q16(const phase_pulse_t *pulse) {
    const uint32_t gap_q16 = PHASE_WIDTH_ALL - pulse->width_q16;
    return least_u32(pulse->ramp_q16, least_u32(gap_q16, pulse->width_q16));
}

int32_t phase_pulse_current_mA(const phase_pulse_t *pulse, uint32_t start_turn,
                               uint32_t length_turn) {
    if (pulse->width_q16 >= PHASE_WIDTH_ALL) {
        return pulse->level_mA;
    }
    // A ramp is the mean over a longer time about the same middle.
    const uint32_t ramp_turn = ramp_q16(pulse) << 16;
    const uint32_t longer = ramp_turn > length_turn ? (ramp_turn - length_turn) / 2u : 0;
    const uint32_t length = length_turn + 2u * longer;
    const uint32_t start = start_turn - longer - ((uint32_t)pulse->on_q16 << 16);
    const uint32_t on = covered(start, length, pulse->width_q16 << 16);
    if (on == 0) {
        return pulse->floor_mA;
    }
    if (on == length) {
        return pulse->level_mA;
    }
    const uint32_t part_q16 = on / ((length >> 16) + 1u);
    const int64_t height_mA = pulse->level_mA - pulse->floor_mA;
    return pulse->floor_mA + (int32_t)((height_mA * part_q16) >> 16);
}
