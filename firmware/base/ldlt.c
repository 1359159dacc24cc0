#include "ldlt.h"

#define SMALLEST_PIVOT_Q30 (1 << 18)
#define LIMIT ((1 << 30) - 1)
#define L_LIMIT_Q24 ((1 << 30) - 1)

void ldlt_start(ldlt_t *self, uint32_t size) {
    self->size = size;
    self->next = 0;
    self->energy = 0;
}

// numerator / pivot in Q24; both in Q30. The pivot's reciprocal has 31 bits.
typedef struct {
    uint32_t mantissa; // 2^63 / (pivot << zeros)
    uint32_t zeros;
} reciprocal_t;

static reciprocal_t reciprocal(int32_t pivot_q30) {
    const uint32_t zeros = (uint32_t)__builtin_clz((uint32_t)pivot_q30);
    return (reciprocal_t){reciprocal_u32((uint32_t)pivot_q30 << zeros), zeros};
}

// value / pivot with `fraction` bits more than value has, value below 2^31.
static int64_t divide(int32_t value, reciprocal_t by, uint32_t fraction) {
    return ((int64_t)value * by.mantissa) >> (63u - by.zeros - fraction);
}

static void eliminate(ldlt_t *self, uint32_t j, int32_t pivot_q30, const int32_t *w_q30) {
    const reciprocal_t by = reciprocal(pivot_q30);
    for (uint32_t i = j + 1u; i < self->size; i++) {
        int32_t *row = &self->matrix[ldlt_index(i, 0)];
        int64_t sum_q54 = (int64_t)row[j] * (1 << 24);
        for (uint32_t k = 0; k < j; k++) {
            sum_q54 -= (int64_t)row[k] * w_q30[k];
        }
        const int32_t rest_q30 = (int32_t)clamp_i64(sum_q54 >> 24, -LIMIT, LIMIT);
        row[j] = (int32_t)clamp_i64(divide(rest_q30, by, 24u), -L_LIMIT_Q24, L_LIMIT_Q24);
        const int64_t right = self->right[i] - (((int64_t)row[j] * self->right[j]) >> 24);
        self->right[i] = (int32_t)clamp_i64(right, -LIMIT, LIMIT);
    }
    const int32_t y = self->right[j];
    self->right[j] = (int32_t)clamp_i64(divide(y, by, 30u), -LIMIT, LIMIT);
    self->energy += (int64_t)y * self->right[j];
}

static void drop(ldlt_t *self, uint32_t j) {
    for (uint32_t i = j + 1u; i < self->size; i++) {
        self->matrix[ldlt_index(i, j)] = 0;
    }
    self->right[j] = 0;
}

static void factor_column(ldlt_t *self, uint32_t j) {
    int32_t w_q30[LDLT_MAX]; // L's row j times D
    const int32_t *row = &self->matrix[ldlt_index(j, 0)];
    int64_t pivot_q54 = (int64_t)row[j] * (1 << 24);
    for (uint32_t k = 0; k < j; k++) {
        w_q30[k] = (int32_t)(((int64_t)row[k] * self->pivot_q30[k]) >> 24);
        pivot_q54 -= (int64_t)row[k] * w_q30[k];
    }
    const int32_t pivot_q30 = (int32_t)clamp_i64(pivot_q54 >> 24, 0, LIMIT + 1);
    self->pivot_q30[j] = pivot_q30 >= SMALLEST_PIVOT_Q30 ? pivot_q30 : 0;
    if (self->pivot_q30[j] == 0) {
        drop(self, j);
    } else {
        eliminate(self, j, pivot_q30, w_q30);
    }
}

static void substitute_back(ldlt_t *self) {
    for (uint32_t j = self->size; j-- > 0;) {
        if (self->pivot_q30[j] == 0) {
            continue;
        }
        int64_t value = self->right[j];
        for (uint32_t i = j + 1u; i < self->size; i++) {
            value -= ((int64_t)self->matrix[ldlt_index(i, j)] * self->right[i]) >> 24;
        }
        self->right[j] = (int32_t)clamp_i64(value, -LIMIT, LIMIT);
    }
}

bool ldlt_step(ldlt_t *self) {
    if (self->next < self->size) {
        factor_column(self, self->next);
        self->next++;
        return false;
    }
    substitute_back(self);
    return true;
}
