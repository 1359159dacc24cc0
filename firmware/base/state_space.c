#include "state_space.h"

#include "fixq.h"

enum { STATE_LIMIT = (1 << 30) - 1 };

bool state_space_are_coefficients_good(const int32_t *coefficients, uint32_t count) {
    bool are_good = true;
    for (uint32_t i = 0; i < count; i++) {
        are_good = are_good && abs_i32(coefficients[i]) < STATE_SPACE_COEFFICIENT_LIMIT;
    }
    return are_good;
}

bool state_space_are_states_good(const int32_t *words, uint32_t n, uint32_t m) {
    bool are_good = true;
    for (uint32_t i = 0; i < n; i++) {
        const int32_t *row = &words[i * (1u + n + m)];
        are_good = are_good && (uint32_t)row[0] <= STATE_SPACE_MAX_SHIFT &&
                   state_space_are_coefficients_good(&row[1], n + m);
    }
    return are_good;
}

static int64_t dot(int64_t sum, const int32_t *a, const int32_t *b, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        sum += (int64_t)a[i] * b[i];
    }
    return sum;
}

int64_t state_space_output(const state_space_t *self, const int32_t *row, uint32_t n, uint32_t m,
                           const int32_t *u) {
    return dot(dot(0, row, self->x, n), &row[n], u, m);
}

// The change of all states before any of them moves.
static void find_changes(state_space_t *self, const int32_t *words, uint32_t n, uint32_t m,
                         const int32_t *u, int64_t change[STATE_SPACE_MAX_STATES]) {
    for (uint32_t i = 0; i < n; i++) {
        const int32_t *row = &words[i * (1u + n + m)];
        const uint32_t shift = (uint32_t)row[0];
        const int64_t sum = dot(dot(self->rest[i], &row[1], self->x, n), &row[1u + n], u, m);
        change[i] = sum >> shift;
        self->rest[i] = (int64_t)((uint64_t)sum & ((UINT64_C(1) << shift) - 1u));
    }
}

bool state_space_step(state_space_t *self, const int32_t *words, uint32_t n, uint32_t m,
                      const int32_t *u) {
    int64_t change[STATE_SPACE_MAX_STATES];
    bool is_inside = true;
    find_changes(self, words, n, m, u, change);
    for (uint32_t i = 0; i < n; i++) {
        const int64_t next = self->x[i] + change[i];
        is_inside = is_inside && next >= -STATE_LIMIT && next <= STATE_LIMIT;
        self->x[i] = (int32_t)clamp_i64(next, -STATE_LIMIT, STATE_LIMIT);
    }
    if (!is_inside) {
        *self = (state_space_t){0};
    }
    return is_inside;
}
