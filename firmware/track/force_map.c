#include "force_map.h"

#include <stddef.h>

#include "sections.h"

enum { SECTION_WORDS = 3, HALF_Q30 = 1 << 29 };

typedef struct {
    uint32_t axis;
    uint32_t places;
    uint32_t currents;
    int32_t value[]; ///< places, currents, forces
} section_t;

_Static_assert(offsetof(section_t, value) == 4u * SECTION_WORDS, "words on the wire");

static const section_t *as_section(const uint32_t *words) {
    return (const section_t *)(const void *)words;
}

static const int32_t *currents_of(const section_t *map) {
    return &map->value[map->places];
}

// At all currents, at one place.
static const int32_t *forces_of(const section_t *map, uint32_t place) {
    return &map->value[map->places + map->currents + place * map->currents];
}

static uint32_t words_in(const section_t *map) {
    return SECTION_WORDS + map->places + map->currents + map->places * map->currents;
}

static uint32_t size(const uint32_t *words, uint32_t left) {
    const section_t *map = as_section(words);
    const bool has_shape = left >= SECTION_WORDS && map->places >= FORCE_MAP_MIN_POINTS &&
                           map->places <= FORCE_MAP_MAX_PLACES &&
                           map->currents >= FORCE_MAP_MIN_POINTS &&
                           map->currents <= FORCE_MAP_MAX_CURRENTS && left >= words_in(map);
    return has_shape ? words_in(map) : 0;
}

static bool is_rising(const int32_t *values, uint32_t count) {
    for (uint32_t i = 1; i < count; i++) {
        if (values[i] <= values[i - 1u]) {
            return false;
        }
    }
    return true;
}

static bool are_axes_good(const section_t *map) {
    const int32_t *place = map->value;
    const int32_t *current_mA = currents_of(map);
    return (map->axis == QUIESCE_SENSE_STROKE_VELOCITY || map->axis == QUIESCE_SENSE_STROKE) &&
           is_rising(place, map->places) && is_rising(current_mA, map->currents) &&
           place[0] >= -VIEW_LIMIT && place[0] < 0 && place[map->places - 1u] > 0 &&
           place[map->places - 1u] <= VIEW_LIMIT && current_mA[0] == 0 &&
           current_mA[map->currents - 1u] <= QUIESCE_HIGHEST_CURRENT_mA;
}

// With the current forces go the way of the place, or stay.
static bool are_forces_good(const section_t *map, uint32_t place) {
    const int32_t *force_mN = forces_of(map, place);
    const int32_t way = map->value[place];
    for (uint32_t i = 0; i < map->currents; i++) {
        if (force_mN[i] < -VIEW_LIMIT || force_mN[i] > VIEW_LIMIT) {
            return false;
        }
        const bool falls = i > 0 && force_mN[i] < force_mN[i - 1u];
        const bool rises = i > 0 && force_mN[i] > force_mN[i - 1u];
        if ((falls && way >= 0) || (rises && way <= 0)) {
            return false;
        }
    }
    return true;
}

static bool is_good(const uint32_t *words) {
    const section_t *map = as_section(words);
    for (uint32_t i = 0; i < map->places; i++) {
        if (!are_forces_good(map, i)) {
            return false;
        }
    }
    return are_axes_good(map);
}

static bool is_over_stroke(const section_t *map) {
    return map->axis == QUIESCE_SENSE_STROKE;
}

static uint64_t axis_needs(const uint32_t *words, uint32_t i) {
    return (is_over_stroke(as_section(words)) ? VIEW_STROKE : VIEW_STROKE_VELOCITY) << i;
}

static const sections_kind_t kind = {
    .size = size,
    .is_good = is_good,
    .needs = axis_needs,
};

quiesce_table_verdict_t force_map_check(const uint32_t *words) {
    return sections_check(&kind, words);
}

const uint32_t *force_map_section(const uint32_t *words, uint32_t damper) {
    return sections_shared(&kind, words, damper);
}

uint64_t force_map_needs(const uint32_t *words) {
    return sections_shared_need(&kind, words);
}

int32_t force_map_place(const uint32_t *section, const view_damper_t *damper) {
    return is_over_stroke(as_section(section)) ? damper->stroke_nm : damper->velocity_um_s;
}

// Forces at the present place, in the direction of the demand.
typedef struct {
    const int32_t *below;
    const int32_t *above;
    int64_t part_q30; ///< of the way from below to above
    int32_t side;     ///< -1 or 1
} row_t;

// The last of the axis at or below this place, and not the last of all.
static uint32_t index_of(const section_t *map, int32_t place) {
    uint32_t low = 0;
    uint32_t high = map->places - 1u;
    while (high - low > 1u) {
        const uint32_t middle = (low + high) / 2u;
        if (map->value[middle] <= place) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static row_t row_at(const section_t *map, int32_t place, int32_t side) {
    const uint32_t index = index_of(map, place);
    const int64_t low = map->value[index];
    const int64_t high = map->value[index + 1u];
    const int64_t at = clamp_i64(place, low, high);
    row_t row = {forces_of(map, index), forces_of(map, index + 1u), 0, side};
    if (low < 0 && high > 0) {
        // The direction changes here.
        row.below = row.above = side > 0 ? row.above : row.below;
    } else {
        row.part_q30 = (int64_t)((uint64_t)(at - low) << 30) / (high - low);
    }
    return row;
}

static int64_t force_at_mN(const row_t *row, uint32_t current) {
    const int64_t below_mN = row->below[current];
    const int64_t change_mN = row->above[current] - below_mN;
    return row->side * (below_mN + ((change_mN * row->part_q30 + HALF_Q30) >> 30));
}

// Two currents beside each other: the force at low is below the wanted one, that at high is not.
typedef struct {
    uint32_t low;
    uint32_t high;
    int64_t low_mN;
    int64_t high_mN;
} bracket_t;

static void narrow(bracket_t *self, const row_t *row, int64_t wanted_mN) {
    while (self->high - self->low > 1u) {
        const uint32_t middle = (self->low + self->high) / 2u;
        const int64_t middle_mN = force_at_mN(row, middle);
        if (middle_mN < wanted_mN) {
            self->low = middle;
            self->low_mN = middle_mN;
        } else {
            self->high = middle;
            self->high_mN = middle_mN;
        }
    }
}

int32_t force_map_current_mA(const uint32_t *section, int32_t place, int32_t demand_mN) {
    const section_t *map = as_section(section);
    const int32_t *current_mA = currents_of(map);
    const row_t row = row_at(map, place, demand_mN > 0 ? 1 : -1);
    const int64_t wanted_mN = (int64_t)demand_mN * row.side;
    const uint32_t last = map->currents - 1u;
    bracket_t at = {0, last, force_at_mN(&row, 0), force_at_mN(&row, last)};
    if (wanted_mN <= at.low_mN) {
        return 0;
    }
    if (wanted_mN > at.high_mN) {
        return current_mA[last];
    }
    narrow(&at, &row, wanted_mN);
    const uint64_t step_mA = (uint32_t)(current_mA[at.high] - current_mA[at.low]);
    const uint64_t gap_mN = (uint64_t)(at.high_mN - at.low_mN);
    const uint64_t product = step_mA * (uint64_t)(wanted_mN - at.low_mN);
    return current_mA[at.low] + (int32_t)((product + gap_mN / 2u) / gap_mN);
}
