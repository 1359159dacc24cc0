#include "fuzzy.h"

static uint32_t ramp_q15(uint32_t distance, uint32_t slope) {
    const uint64_t height = ((uint64_t)distance * slope) >> 31;
    return height < FUZZY_ONE_q15 ? (uint32_t)height : FUZZY_ONE_q15;
}

uint32_t fuzzy_membership_q15(const fuzzy_set_t *set, int32_t x) {
    if (x < set->left_foot || x > set->right_foot) {
        return 0;
    }
    if (x < set->left_top) {
        return ramp_q15((uint32_t)x - (uint32_t)set->left_foot, set->rise);
    }
    if (x > set->right_top) {
        return ramp_q15((uint32_t)set->right_foot - (uint32_t)x, set->fall);
    }
    return FUZZY_ONE_q15;
}

static void memberships_q15(const fuzzy_set_t sets[FUZZY_SETS], int32_t x,
                            uint32_t out_q15[FUZZY_SETS]) {
    for (uint32_t i = 0; i < FUZZY_SETS; i++) {
        out_q15[i] = fuzzy_membership_q15(&sets[i], x);
    }
}

typedef struct {
    uint64_t weighted; // strength x singleton
    uint32_t strength;
    uint32_t fired;
} sums_t;

static void add_row(const fuzzy_table_t *table, uint32_t i, uint32_t row_q15,
                    const uint32_t column_q15[FUZZY_SETS], sums_t *sums) {
    for (uint32_t j = 0; j < FUZZY_SETS; j++) {
        const uint32_t strength = row_q15 < column_q15[j] ? row_q15 : column_q15[j];
        if (strength != 0) {
            const int32_t singleton_mA = table->singleton_mA[table->rule[i][j]];
            sums->strength += strength;
            sums->weighted += (uint64_t)strength * (uint32_t)singleton_mA;
            sums->fired |= 1u << (i * FUZZY_SETS + j);
        }
    }
}

// To nearest; a 64-bit division costs a library call and is rarely needed.
static int32_t rounded_ratio(uint64_t weighted, uint32_t strength) {
    const uint64_t sum = weighted + strength / 2u;
    return (int32_t)(sum <= UINT32_MAX ? (uint32_t)sum / strength : sum / strength);
}

fuzzy_out_t fuzzy_evaluate(const fuzzy_table_t *table, int32_t row_input, int32_t column_input) {
    uint32_t row_q15[FUZZY_SETS];
    uint32_t column_q15[FUZZY_SETS];
    memberships_q15(table->row, row_input, row_q15);
    memberships_q15(table->column, column_input, column_q15);

    sums_t sums = {0};
    for (uint32_t i = 0; i < FUZZY_SETS; i++) {
        if (row_q15[i] != 0) {
            add_row(table, i, row_q15[i], column_q15, &sums);
        }
    }
    if (sums.strength == 0) {
        return (fuzzy_out_t){table->default_mA, 0};
    }
    return (fuzzy_out_t){rounded_ratio(sums.weighted, sums.strength), sums.fired};
}
