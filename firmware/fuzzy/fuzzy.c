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

fuzzy_out_t fuzzy_evaluate(const fuzzy_table_t *table, int32_t row_input, int32_t column_input) {
    uint32_t row_q15[FUZZY_SETS];
    uint32_t column_q15[FUZZY_SETS];
    memberships_q15(table->row, row_input, row_q15);
    memberships_q15(table->column, column_input, column_q15);

    uint32_t strength_sum = 0;
    uint64_t weighted_sum = 0;
    uint32_t fired = 0;
    for (uint32_t i = 0; i < FUZZY_SETS; i++) {
        for (uint32_t j = 0; j < FUZZY_SETS; j++) {
            const uint32_t strength = row_q15[i] < column_q15[j] ? row_q15[i] : column_q15[j];
            if (strength != 0) {
                const int32_t singleton_mA = table->singleton_mA[table->rule[i][j]];
                strength_sum += strength;
                weighted_sum += (uint64_t)strength * (uint32_t)singleton_mA;
                fired |= 1u << (i * FUZZY_SETS + j);
            }
        }
    }
    if (strength_sum == 0) {
        return (fuzzy_out_t){table->default_mA, 0};
    }
    return (fuzzy_out_t){(int32_t)((weighted_sum + strength_sum / 2u) / strength_sum), fired};
}
