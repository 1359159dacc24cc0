#include "force_map.h"

#include <stddef.h>

#include "table.h"
#include "view.h"

enum { HEADER_WORDS = 5, HALF_Q30 = 1 << 29 };

typedef struct {
    uint32_t head[TABLE_HEAD_WORDS];
    uint32_t velocities;
    uint32_t currents;
    int32_t value[]; ///< velocities, currents, forces
} force_map_t;

_Static_assert(offsetof(force_map_t, value) == 4u * HEADER_WORDS, "words on the wire");

static const force_map_t *as_map(const uint32_t *words) {
    return (const force_map_t *)(const void *)words;
}

static const int32_t *currents_of(const force_map_t *map) {
    return &map->value[map->velocities];
}

// At all currents, at one velocity.
static const int32_t *forces_of(const force_map_t *map, uint32_t velocity) {
    return &map->value[map->velocities + map->currents + velocity * map->currents];
}

static bool has_shape(const force_map_t *map) {
    const uint32_t n = map->velocities;
    const uint32_t m = map->currents;
    return n >= FORCE_MAP_MIN_POINTS && n <= FORCE_MAP_MAX_VELOCITIES &&
           m >= FORCE_MAP_MIN_POINTS && m <= FORCE_MAP_MAX_CURRENTS &&
           map->head[TABLE_WORDS] == HEADER_WORDS + n + m + n * m;
}

static bool is_rising(const int32_t *values, uint32_t count) {
    for (uint32_t i = 1; i < count; i++) {
        if (values[i] <= values[i - 1u]) {
            return false;
        }
    }
    return true;
}

static bool are_axes_good(const force_map_t *map) {
    const int32_t *velocity_um_s = map->value;
    const int32_t *current_mA = currents_of(map);
    return is_rising(velocity_um_s, map->velocities) && is_rising(current_mA, map->currents) &&
           velocity_um_s[0] >= -VIEW_LIMIT && velocity_um_s[0] < 0 &&
           velocity_um_s[map->velocities - 1u] > 0 &&
           velocity_um_s[map->velocities - 1u] <= VIEW_LIMIT && current_mA[0] == 0 &&
           current_mA[map->currents - 1u] <= QUIESCE_HIGHEST_CURRENT_mA;
}

// With the current forces go the way of the velocity, or stay.
static bool are_forces_good(const force_map_t *map, uint32_t velocity) {
    const int32_t *force_mN = forces_of(map, velocity);
    const int32_t way = map->value[velocity];
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

static bool are_points_good(const force_map_t *map) {
    for (uint32_t i = 0; i < map->velocities; i++) {
        if (!are_forces_good(map, i)) {
            return false;
        }
    }
    return are_axes_good(map);
}

quiesce_table_verdict_t quiesce_force_map_check(const uint32_t *words, uint32_t count) {
    const force_map_t *map = as_map(words);
    const quiesce_table_verdict_t verdict =
        table_check_head(words, count, FORCE_MAP_MAGIC, HEADER_WORDS - TABLE_HEAD_WORDS);
    if (verdict != QUIESCE_TABLE_OK) {
        return verdict;
    }
    if (!has_shape(map)) {
        return QUIESCE_TABLE_SHAPE;
    }
    return are_points_good(map) ? QUIESCE_TABLE_OK : QUIESCE_TABLE_POINT;
}

// Forces at the present velocity, in the direction of the demand.
typedef struct {
    const int32_t *below;
    const int32_t *above;
    int64_t part_q30; ///< of the way from below to above
    int32_t side;     ///< -1 or 1
} row_t;

// The last velocity at or below this one, and not the last of all.
static uint32_t place_of(const force_map_t *map, int32_t velocity_um_s) {
    uint32_t low = 0;
    uint32_t high = map->velocities - 1u;
    while (high - low > 1u) {
        const uint32_t middle = (low + high) / 2u;
        if (map->value[middle] <= velocity_um_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static row_t row_at(const force_map_t *map, int32_t velocity_um_s, int32_t side) {
    const uint32_t place = place_of(map, velocity_um_s);
    const int64_t low = map->value[place];
    const int64_t high = map->value[place + 1u];
    const int64_t at = clamp_i64(velocity_um_s, low, high);
    row_t row = {forces_of(map, place), forces_of(map, place + 1u), 0, side};
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

int32_t force_map_current_mA(const uint32_t *words, int32_t velocity_um_s, int32_t demand_mN) {
    const force_map_t *map = as_map(words);
    const int32_t *current_mA = currents_of(map);
    const row_t row = row_at(map, velocity_um_s, demand_mN > 0 ? 1 : -1);
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
