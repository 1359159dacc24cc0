// What four corners say about where to move, on costs that are known.
#include "adapt_square.h"

#include "test_signal.h"
#include "unity.h"

enum {
    LEAST_q20 = 2000, // some 0.2 %
    ONE_q20 = 10486,  // 1 %
};

static adapt_square_t square;

void setUp(void) {
    square = (adapt_square_t){0};
}
void tearDown(void) {}

// A round whose corners cost so much, in their order (++, -+, --, +-), and the centre in the end.
static void take_round(const int32_t cost_q20[ADAPT_CORNERS], int32_t centre_q20) {
    for (uint32_t i = 0; i < ADAPT_CORNERS; i++) {
        TEST_ASSERT_EQUAL_UINT32(i, square.corner);
        adapt_square_take(&square, cost_q20[i]);
    }
    adapt_square_close(&square, centre_q20);
}

static void assert_move(int on, int off, int32_t noise_q20) {
    const adapt_move_t move = adapt_square_move(&square, noise_q20, LEAST_q20);
    TEST_ASSERT_EQUAL_INT(on, move.on);
    TEST_ASSERT_EQUAL_INT(off, move.off);
    TEST_ASSERT_EQUAL(on != 0 || off != 0, adapt_is_move(move));
}

static void test_corners_go_round(void) {
    for (uint32_t i = 0; i < ADAPT_CORNERS; i++) {
        const adapt_move_t here = adapt_square_corner(i);
        const adapt_move_t next = adapt_square_corner(i + 1u);
        TEST_ASSERT_TRUE(here.on * here.on == 1 && here.off * here.off == 1);
        TEST_ASSERT_EQUAL_INT(1, (here.on != next.on) + (here.off != next.off));
    }
}

// Planes that fall in every direction.
static void test_it_moves_downhill(void) {
    for (int on = -1; on <= 1; on++) {
        for (int off = -1; off <= 1; off++) {
            setUp();
            int32_t cost_q20[ADAPT_CORNERS];
            for (uint32_t i = 0; i < ADAPT_CORNERS; i++) {
                const adapt_move_t at = adapt_square_corner(i);
                cost_q20[i] = -ONE_q20 * (on * at.on + off * at.off);
            }
            take_round(cost_q20, 0);
            assert_move(on, off, 0);
        }
    }
}

// A valley along the diagonal: neither edge alone gains anything.
static void test_it_moves_along_a_diagonal(void) {
    take_round((const int32_t[]){-ONE_q20, ONE_q20, 0, ONE_q20}, 0);
    assert_move(1, 1, 0);
}

// Where all corners cost more there is nothing to gain, whatever they differ by.
static void test_it_stays_in_a_bowl(void) {
    take_round((const int32_t[]){ONE_q20, 4 * ONE_q20, 2 * ONE_q20, 9 * ONE_q20}, 0);
    TEST_ASSERT_EQUAL_INT32(4 * ONE_q20, adapt_square_bend_q20(&square));
    assert_move(0, 0, 0);
}

static void test_it_stays_where_the_gain_is_less_than_the_least(void) {
    take_round((const int32_t[]){-LEAST_q20, LEAST_q20, LEAST_q20, -LEAST_q20}, 0);
    assert_move(0, 0, 0);
}

// What noise of one round hides, three show.
static void test_rounds_add_up_against_noise(void) {
    const int32_t cost_q20[] = {-ONE_q20, ONE_q20, ONE_q20, -ONE_q20};
    take_round(cost_q20, 0);
    const int32_t chance_q20 = adapt_square_chance_q20(&square, 2 * ONE_q20);
    assert_move(0, 0, 2 * ONE_q20);
    take_round(cost_q20, 0);
    take_round(cost_q20, 0);
    TEST_ASSERT_EQUAL_UINT32(ADAPT_MOST_ROUNDS, square.rounds);
    TEST_ASSERT_LESS_THAN_INT32(chance_q20 * 6 / 10, adapt_square_chance_q20(&square, 2 * ONE_q20));
    assert_move(1, 0, 2 * ONE_q20);
}

// The excitation drifts, or makes a step before any measurement: no slope of the plant.
static void test_it_does_not_follow_the_excitation(void) {
    for (int32_t size_q20 = -2 * ONE_q20; size_q20 <= 2 * ONE_q20; size_q20 += ONE_q20 / 3) {
        int32_t cost_q20[ADAPT_CORNERS];
        for (int32_t i = 0; i < ADAPT_CORNERS; i++) {
            cost_q20[i] = size_q20 * (i + 1) / 5;
        }
        setUp();
        take_round(cost_q20, size_q20);
        assert_move(0, 0, 0);
        for (int32_t from = 0; from <= ADAPT_CORNERS; from++) {
            for (int32_t i = 0; i < ADAPT_CORNERS; i++) {
                cost_q20[i] = i >= from ? size_q20 : 0;
            }
            setUp();
            take_round(cost_q20, size_q20);
            assert_move(0, 0, 0);
        }
    }
}

// Back to where it has come from means that the best place is in between.
static void test_an_edge_does_not_go_back(void) {
    adapt_square_moved(&square, (adapt_move_t){1, -1});
    adapt_move_t move = adapt_square_forward(&square, (adapt_move_t){-1, -1});
    TEST_ASSERT_EQUAL_INT(0, move.on);
    TEST_ASSERT_EQUAL_INT(-1, move.off);
    adapt_square_moved(&square, (adapt_move_t){0, -1});
    move = adapt_square_forward(&square, (adapt_move_t){-1, 1});
    TEST_ASSERT_FALSE(adapt_is_move(move));
    adapt_square_restart(&square); // keeps that
    TEST_ASSERT_EQUAL_INT(1, square.last.on);
    move = adapt_square_forward(&square, (adapt_move_t){1, 0});
    TEST_ASSERT_EQUAL_INT(1, move.on);
}

// Costs at their largest, and a noise of the same size, stay inside their words.
static void test_the_largest_costs_do_not_overflow(void) {
    uint32_t seed = 11;
    for (uint32_t trial = 0; trial < 20000; trial++) {
        setUp();
        for (uint32_t round = 0; round < ADAPT_MOST_ROUNDS; round++) {
            int32_t cost_q20[ADAPT_CORNERS];
            for (uint32_t i = 0; i < ADAPT_CORNERS; i++) {
                cost_q20[i] = signal_noise(&seed, ADAPT_MOST_COST_Q20);
            }
            take_round(cost_q20, signal_noise(&seed, ADAPT_MOST_COST_Q20));
            const adapt_move_t move = adapt_square_move(&square, 1 << 24, LEAST_q20);
            TEST_ASSERT_INT_WITHIN(1, 0, move.on);
            TEST_ASSERT_INT_WITHIN(1, 0, move.off);
        }
    }
}

// A bowl s on + b (on^2 + off^2): s^2 / (4 b) below its centre, or a whole step where that is
// nearer.
static void test_hope_is_what_a_parabola_leaves(void) {
    const struct {
        int32_t slope_q20, bend_q20, expected_q20;
    } rows[] = {
        {0, ONE_q20, 0},
        {ONE_q20, ONE_q20, ONE_q20 / 4},
        {-2 * ONE_q20, 4 * ONE_q20, ONE_q20 / 4},
        {4 * ONE_q20, ONE_q20, 3 * ONE_q20},
        {ONE_q20, 0, ONE_q20},
    };
    for (uint32_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        setUp();
        int32_t cost_q20[ADAPT_CORNERS];
        for (uint32_t k = 0; k < ADAPT_CORNERS; k++) {
            cost_q20[k] = rows[i].slope_q20 * adapt_square_corner(k).on + 2 * rows[i].bend_q20;
        }
        take_round(cost_q20, 0);
        TEST_ASSERT_INT32_WITHIN(2, rows[i].expected_q20, adapt_square_hope_q20(&square, 0));
        TEST_ASSERT_GREATER_THAN_INT32(rows[i].expected_q20,
                                       adapt_square_hope_q20(&square, ONE_q20));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_corners_go_round);
    RUN_TEST(test_it_moves_downhill);
    RUN_TEST(test_it_moves_along_a_diagonal);
    RUN_TEST(test_it_stays_in_a_bowl);
    RUN_TEST(test_it_stays_where_the_gain_is_less_than_the_least);
    RUN_TEST(test_rounds_add_up_against_noise);
    RUN_TEST(test_it_does_not_follow_the_excitation);
    RUN_TEST(test_an_edge_does_not_go_back);
    RUN_TEST(test_the_largest_costs_do_not_overflow);
    RUN_TEST(test_hope_is_what_a_parabola_leaves);
    return UNITY_END();
}
