#include "ldlt.h"

#include "test_signal.h"
#include "unity.h"

#define ONE_Q30 1073741824
#define PIVOT_LIMIT_Q30 (1 << 18) // 2^-12

// Of random systems: 10^-7 over the smallest pivot, 0.14, of solutions up to 6.6 x 10^7; twice
// that.
#define TOLERANCE 94

static ldlt_t system;

void setUp(void) {}
void tearDown(void) {}

// Solves what stands in `system`: a column a call.
static void solve(void) {
    for (uint32_t calls = 0; !ldlt_step(&system); calls++) {
        TEST_ASSERT_TRUE(calls < system.size);
    }
}

static void put(uint32_t row, uint32_t column, int32_t entry_q30) {
    system.matrix[ldlt_index(row, column)] = entry_q30;
}

// A system made from integers: matrix = factor x factor^T in Q16, and a solution in steps of 2^16,
// so that the right side is an exact integer, too.
typedef struct {
    uint32_t size;
    int32_t factor_q8[LDLT_MAX][LDLT_MAX]; // lower triangular, rows no longer than 1
    int32_t solution[LDLT_MAX];
} made_t;

static int32_t entry_q16(const made_t *made, uint32_t i, uint32_t j) {
    int32_t sum = 0;
    for (uint32_t k = 0; k < made->size; k++) {
        sum += made->factor_q8[i][k] * made->factor_q8[j][k];
    }
    return sum;
}

// Returns solution times right side.
static int64_t enter(const made_t *made) {
    int64_t energy = 0;
    ldlt_start(&system, made->size);
    for (uint32_t i = 0; i < made->size; i++) {
        int32_t right = 0;
        for (uint32_t j = 0; j < made->size; j++) {
            right += entry_q16(made, i, j) * (made->solution[j] >> 16);
        }
        for (uint32_t j = 0; j <= i; j++) {
            put(i, j, entry_q16(made, i, j) * (1 << 14));
        }
        system.right[i] = right;
        energy += (int64_t)right * made->solution[i];
    }
    return energy;
}

// Pivots from 0.14 to 0.48.
static made_t random_system(uint32_t *seed, uint32_t size) {
    made_t made = {.size = size};
    for (uint32_t i = 0; i < size; i++) {
        for (uint32_t k = 0; k < i; k++) {
            made.factor_q8[i][k] = signal_noise(seed, 40);
        }
        made.factor_q8[i][i] = 136 + signal_noise(seed, 40);
        made.solution[i] = signal_noise(seed, 1000) * (1 << 16);
    }
    return made;
}

static void assert_energy(int64_t expected) {
    const int64_t off = system.energy - expected;
    const int64_t most = (expected >> 18) + (1 << 20);
    TEST_ASSERT_TRUE(off >= -most && off <= most);
}

static void assert_solution(const made_t *made, uint32_t tolerance) {
    for (uint32_t i = 0; i < made->size; i++) {
        TEST_ASSERT_INT32_WITHIN(tolerance, made->solution[i], system.right[i]);
    }
}

static void test_one_unknown(void) {
    ldlt_start(&system, 1);
    put(0, 0, ONE_Q30 / 4);
    system.right[0] = 12345;
    solve();
    TEST_ASSERT_INT32_WITHIN(1, 49380, system.right[0]);
    assert_energy(INT64_C(12345) * 49380);
}

static void test_unit_matrix_leaves_the_right_side(void) {
    ldlt_start(&system, LDLT_MAX);
    for (uint32_t i = 0; i < LDLT_MAX; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            put(i, j, i == j ? ONE_Q30 : 0);
        }
        system.right[i] = (int32_t)i * 1000000 - 4000000;
    }
    solve();
    for (uint32_t i = 0; i < LDLT_MAX; i++) {
        TEST_ASSERT_INT32_WITHIN(1, (int32_t)i * 1000000 - 4000000, system.right[i]);
    }
}

// 1    1/2  1/4     8000000     9000000
// 1/2  1    1/2  x  4000000  =  6000000
// 1/4  1/2  1      -4000000     0
static void test_three_unknowns(void) {
    ldlt_start(&system, 3);
    for (uint32_t i = 0; i < 3; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            put(i, j, ONE_Q30 >> (i - j));
        }
    }
    system.right[0] = 9000000;
    system.right[1] = 6000000;
    system.right[2] = 0;
    solve();
    TEST_ASSERT_INT32_WITHIN(4, 8000000, system.right[0]);
    TEST_ASSERT_INT32_WITHIN(4, 4000000, system.right[1]);
    TEST_ASSERT_INT32_WITHIN(4, -4000000, system.right[2]);
    assert_energy(INT64_C(96000000000000));
    TEST_ASSERT_INT32_WITHIN(108, ONE_Q30, system.pivot_q30[0]);
    TEST_ASSERT_INT32_WITHIN(108, ONE_Q30 / 4 * 3, system.pivot_q30[1]);
    TEST_ASSERT_INT32_WITHIN(108, ONE_Q30 / 4 * 3, system.pivot_q30[2]);
}

static void test_random_systems_of_every_size(void) {
    uint32_t seed = 5;
    for (uint32_t i = 0; i < 900; i++) {
        const made_t made = random_system(&seed, i % LDLT_MAX + 1u);
        const int64_t energy = enter(&made);
        solve();
        assert_solution(&made, TOLERANCE);
        assert_energy(energy);
    }
}

// Row `which` becomes half the difference of two others: its unknown stays at zero, and nothing
// else changes.
static void test_dependent_column_is_dropped_and_the_rest_stays_right(void) {
    uint32_t seed = 9;
    for (uint32_t i = 0; i < 700; i++) {
        const uint32_t which = 2u + i % (LDLT_MAX - 2u);
        made_t made = random_system(&seed, LDLT_MAX);
        int32_t *dependent = made.factor_q8[which];
        for (uint32_t k = 0; k < LDLT_MAX; k++) {
            made.factor_q8[0][k] &= ~1; // so that halves are exact
            made.factor_q8[which - 1u][k] &= ~1;
            dependent[k] = (made.factor_q8[0][k] - made.factor_q8[which - 1u][k]) / 2;
        }
        made.solution[which] = 0;
        const int64_t energy = enter(&made);
        solve();
        TEST_ASSERT_EQUAL_INT32(0, system.pivot_q30[which]);
        TEST_ASSERT_EQUAL_INT32(0, system.right[which]);
        assert_solution(&made, TOLERANCE);
        assert_energy(energy);
    }
}

// What is asked of a dropped unknown does not matter to the others.
static void test_dropped_unknown_ignores_its_right_side(void) {
    ldlt_start(&system, 3);
    put(0, 0, ONE_Q30);
    put(1, 0, ONE_Q30 / 2);
    put(1, 1, ONE_Q30 / 4);
    put(2, 0, 0);
    put(2, 1, 0);
    put(2, 2, ONE_Q30 / 2);
    system.right[0] = 5000000;
    system.right[1] = -999999;
    system.right[2] = 7000000;
    solve();
    TEST_ASSERT_INT32_WITHIN(1, 5000000, system.right[0]);
    TEST_ASSERT_EQUAL_INT32(0, system.right[1]);
    TEST_ASSERT_INT32_WITHIN(1, 14000000, system.right[2]);
}

static void solve_with_second_pivot(int32_t pivot_q30) {
    ldlt_start(&system, 2);
    put(0, 0, ONE_Q30);
    put(1, 0, ONE_Q30 / 2);
    put(1, 1, ONE_Q30 / 4 + pivot_q30);
    system.right[0] = 40000000;
    system.right[1] = 20000000 + 1000; // the second unknown is the excess over the pivot
    solve();
}

static void test_pivots_down_to_the_limit_are_kept(void) {
    solve_with_second_pivot(PIVOT_LIMIT_Q30 + 256);
    TEST_ASSERT_INT32_WITHIN(256, PIVOT_LIMIT_Q30 + 256, system.pivot_q30[1]);
    TEST_ASSERT_INT32_WITHIN(16400, 4092004, system.right[1]); // 10^-7 of 4e7 over the pivot
    TEST_ASSERT_INT32_WITHIN(8200, 40000000 - 2046002, system.right[0]);
    solve_with_second_pivot(PIVOT_LIMIT_Q30 - 256);
    TEST_ASSERT_EQUAL_INT32(0, system.pivot_q30[1]);
    TEST_ASSERT_EQUAL_INT32(0, system.right[1]);
    TEST_ASSERT_INT32_WITHIN(1, 40000000, system.right[0]);
}

static void test_nothing_gives_nothing(void) {
    ldlt_start(&system, LDLT_MAX);
    for (uint32_t i = 0; i < LDLT_MAX; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            put(i, j, 0);
        }
        system.right[i] = 1000000;
    }
    solve();
    for (uint32_t i = 0; i < LDLT_MAX; i++) {
        TEST_ASSERT_EQUAL_INT32(0, system.right[i]);
    }
    TEST_ASSERT_TRUE(system.energy == 0);
}

static void test_solution_saturates(void) {
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        ldlt_start(&system, 2);
        put(0, 0, ONE_Q30);
        put(1, 0, 0);
        put(1, 1, PIVOT_LIMIT_Q30);
        system.right[0] = sign * (ONE_Q30 - 1);
        system.right[1] = sign * (ONE_Q30 - 1);
        solve();
        TEST_ASSERT_INT32_WITHIN(1, sign * (ONE_Q30 - 1), system.right[0]);
        TEST_ASSERT_EQUAL_INT32(sign * (ONE_Q30 - 1), system.right[1]);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_one_unknown);
    RUN_TEST(test_unit_matrix_leaves_the_right_side);
    RUN_TEST(test_three_unknowns);
    RUN_TEST(test_random_systems_of_every_size);
    RUN_TEST(test_dependent_column_is_dropped_and_the_rest_stays_right);
    RUN_TEST(test_dropped_unknown_ignores_its_right_side);
    RUN_TEST(test_pivots_down_to_the_limit_are_kept);
    RUN_TEST(test_nothing_gives_nothing);
    RUN_TEST(test_solution_saturates);
    return UNITY_END();
}
