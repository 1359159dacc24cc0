#include <string.h>

#include "adapt_plant.h"

// --- search

static void assert_converges(int32_t on, int32_t off, int32_t level) {
    setUp();
    plant.reach = (bowl_t){{on, off, level}, {200000, 150000, 100000}};
    plant.noise_ppm = 400;
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 150 * TRIAL_TICKS));
    adapt_trim_t best;
    for (uint32_t i = 0; i < ADAPT_COORDINATES; i++) {
        best.value[i] = (int16_t)clamp_i32(plant.reach.best[i], -limit_of(i),
                                           i >= ADAPT_LEVEL ? 0 : limit_of(i));
    }
    TEST_ASSERT_TRUE(adapt_is_allowed(&cfg, learnt()));
    TEST_ASSERT_LESS_OR_EQUAL_INT32(bowl_ppm(&plant.reach, &best) + 10000,
                                    bowl_ppm(&plant.reach, learnt()));
}

static void test_adapt_converges_to_the_best_inside_its_limits(void) {
    assert_converges(0, 0, 0);
    assert_converges(30 * DEGREE_q16, -20 * DEGREE_q16, -8000);
    assert_converges(-40 * DEGREE_q16, -40 * DEGREE_q16, 0);
    assert_converges(10 * DEGREE_q16, 44 * DEGREE_q16, -16000);
}

static void test_adapt_converges_to_the_limits_where_the_best_is_beyond(void) {
    assert_converges(60 * DEGREE_q16, -70 * DEGREE_q16, 16000);
    assert_converges(-80 * DEGREE_q16, 70 * DEGREE_q16, -30000);
}

static void test_adapt_rests_with_nothing_learnt_where_nothing_is_to_gain(void) {
    plant.noise_ppm = 800;
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 60 * TRIAL_TICKS));
    assert_nothing_learnt();
    TEST_ASSERT_GREATER_THAN_UINT32(0, adapt.trials);
}

static void test_adapt_rests_as_long_as_told_then_tries_again(void) {
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 60 * TRIAL_TICKS));
    const uint32_t trials = adapt.trials;
    for (uint32_t i = 0; i < cfg.rest_ticks; i++) {
        tick();
        TEST_ASSERT_EQUAL(ADAPT_RESTING, adapt.state);
    }
    run(3 * TRIAL_TICKS);
    TEST_ASSERT_GREATER_THAN_UINT32(trials, adapt.trials);
}

// The plant changes; so does what is learnt.
static void test_adapt_follows_a_plant_that_changes_while_it_rests(void) {
    plant.reach = (bowl_t){{20 * DEGREE_q16, 0, 0}, {200000, 150000, 100000}};
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 150 * TRIAL_TICKS));
    plant.reach.best[ADAPT_ON_EDGE] = -10 * DEGREE_q16;
    run(cfg.rest_ticks + 100);
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 150 * TRIAL_TICKS));
    TEST_ASSERT_INT32_WITHIN(8 * DEGREE_q16, -10 * DEGREE_q16, learnt()->value[ADAPT_ON_EDGE]);
}

static void test_adapt_waits_for_a_vibration_that_lasts(void) {
    run(cfg.start_ticks + MEASURE_TICKS);
    TEST_ASSERT_EQUAL(ADAPT_MEASURING, adapt.state);
    run(SETTLE_TICKS + 100);
    TEST_ASSERT_EQUAL(ADAPT_TRYING, adapt.state);
}

// A plant whose best is no gap at all; then one where the gap is better again.
static void test_adapt_tries_first_to_close_the_gap_and_opens_it_again(void) {
    plant.reach = (bowl_t){{30 * DEGREE_q16, 0, 0, 1}, {50000, 100000, 100000, 200000}};
    plant.now_reach_ppm = bowl_ppm(&plant.reach, &plant.trim);
    TEST_ASSERT_TRUE(run_until(ADAPT_TRYING, 2 * TRIAL_TICKS));
    TEST_ASSERT_EQUAL_INT16(1, adapt_trim_at(&adapt, aim.index, 0).value[ADAPT_WHOLE]);
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 100 * TRIAL_TICKS));
    TEST_ASSERT_EQUAL_INT16(1, learnt()->value[ADAPT_WHOLE]);
    TEST_ASSERT_EQUAL_INT16(0, learnt()->value[ADAPT_ON_EDGE]); // there is no edge to move
    plant.reach.best[ADAPT_WHOLE] = 0;
    run(cfg.rest_ticks + 100);
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 150 * TRIAL_TICKS));
    TEST_ASSERT_EQUAL_INT16(0, learnt()->value[ADAPT_WHOLE]);
}

static void test_adapt_leaves_the_gap_open_where_that_is_better(void) {
    plant.reach = (bowl_t){{30 * DEGREE_q16, 0, 0, 0}, {50000, 100000, 100000, 20000}};
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 100 * TRIAL_TICKS));
    TEST_ASSERT_EQUAL_INT16(0, learnt()->value[ADAPT_WHOLE]);
}

// A third harmonic that lowers the peak counts for more than the fundamental that it raises.
static void test_adapt_looks_at_the_peak_rather_than_the_fundamental(void) {
    plant.reach = (bowl_t){{-cfg.edge_limit_q16, 0, 0}, {20000, 0, 0}};
    plant.now_reach_ppm = bowl_ppm(&plant.reach, &plant.trim);
    plant.third_ppm = -2 * WHOLE_ppm; // a ninth of it: 22 % lower a limit on, 6 % higher
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 100 * TRIAL_TICKS));
    TEST_ASSERT_GREATER_THAN_INT32(20 * DEGREE_q16, learnt()->value[ADAPT_ON_EDGE]);
}

static void test_adapt_measures_reach_and_rms(void) {
    plant.reach = (bowl_t){{0}, {0}};
    plant.rms = (bowl_t){{cfg.edge_limit_q16, 0, 0}, {500000, 0, 0}};
    TEST_ASSERT_TRUE(run_until(ADAPT_TRYING, 2 * TRIAL_TICKS));
    TEST_ASSERT_UINT32_WITHIN(2000, WHOLE_ppm, adapt.before.reach_um_s2);
    TEST_ASSERT_UINT32_WITHIN(3000, 1500000, adapt.before.rms_um_s2);
}

// Half cycles with these components, the fundamental at first_deg.
static harmonic_sums_t turned_half(uint32_t first_deg, uint32_t third_deg) {
    const uint32_t degree_turn = 11930465; // a turn / 360
    const uint32_t first_turn = first_deg * degree_turn;
    const uint32_t third_turn = third_deg * degree_turn;
    harmonic_sums_t half = half_of(0, 0, WHOLE_ppm);
    const int64_t parts[HARMONIC_PRODUCTS] = {
        signal_cosine(WHOLE_ppm, first_turn),
        signal_cosine(WHOLE_ppm, first_turn - 90u * degree_turn),
        signal_cosine(WHOLE_ppm, third_turn),
        signal_cosine(WHOLE_ppm, third_turn - 90u * degree_turn),
    };
    for (uint32_t i = 0; i < HARMONIC_PRODUCTS; i++) {
        half.product[i] = parts[i] * HALF_TICKS * 16384;
    }
    return half;
}

// cos(p) + cos(3 p + d) / 9, whatever the phase that it is told from: 1 + 1/9 at d = 0; at half a
// turn cos(p) (12 - 4 cos(p)^2) / 9, 1 - 1/9; at a quarter by search.
static void test_adapt_measures_the_same_reach_at_any_phase(void) {
    const uint32_t expected[] = {1111111, 1044654, 888889, 1044654};
    for (uint32_t turned = 0; turned < 360u; turned += 40u) {
        for (uint32_t i = 0; i < 4u; i++) {
            setUp();
            const harmonic_sums_t half = turned_half(turned, (3u * turned + 90u * i) % 360u);
            in.half = &half;
            for (uint32_t k = 0; k < TRIAL_TICKS && adapt.state != ADAPT_TRYING; k++) {
                step();
            }
            TEST_ASSERT_UINT32_WITHIN(5000, expected[i], adapt.before.reach_um_s2);
        }
    }
}

static void test_adapt_leaves_out_the_half_cycle_in_which_it_settled(void) {
    for (uint32_t i = 0; i <= cfg.start_ticks; i++) {
        step();
    }
    const harmonic_sums_t large = half_of(10 * WHOLE_ppm, 0, 10 * WHOLE_ppm);
    in.half = &large;
    step();
    TEST_ASSERT_TRUE(run_until(ADAPT_TRYING, TRIAL_TICKS));
    TEST_ASSERT_UINT32_WITHIN(2000, WHOLE_ppm, adapt.before.reach_um_s2);
}

// --- goals: reach wants 20 degrees later, acceleration 20 degrees sooner

static int32_t on_edge_with(uint16_t weight_q8, uint16_t shape_q14) {
    setUp();
    plant.reach = (bowl_t){{20 * DEGREE_q16, 0, 0}, {300000, 100000, 100000}};
    plant.rms = (bowl_t){{-20 * DEGREE_q16, 0, 0}, {300000, 100000, 100000}};
    aim.goal = (adapt_goal_t){weight_q8, shape_q14, 0};
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 100 * TRIAL_TICKS));
    return learnt()->value[ADAPT_ON_EDGE] / DEGREE_q16;
}

static void test_adapt_weighs_acceleration(void) {
    TEST_ASSERT_INT32_WITHIN(5, 20, on_edge_with(0, 0));
    TEST_ASSERT_INT32_WITHIN(5, 0, on_edge_with(256, 0));
    TEST_ASSERT_INT32_WITHIN(5, -15, on_edge_with(7 * 256, 0)); // (20 - 7 x 20) / 8
}

// RMS over reach is 1 at no trim: twice that is free, half of it is not.
static void test_adapt_lets_acceleration_go_up_to_its_shape(void) {
    TEST_ASSERT_INT32_WITHIN(5, 20, on_edge_with(7 * 256, 2 << 14));
    TEST_ASSERT_LESS_THAN_INT32(5, on_edge_with(7 * 256, 1 << 13));
    // At no trim it is all that is free: later is reach's gain, but more acceleration.
    TEST_ASSERT_INT32_WITHIN(4, 0, on_edge_with(20 * 256, 1 << 14));
}

// --- what must not be learnt

static void test_adapt_does_not_learn_a_drift_of_the_excitation(void) {
    const int32_t drifts_ppm[] = {-100, -400, -1000, -3000, 100, 400, 1000, 3000};
    for (uint32_t i = 0; i < sizeof drifts_ppm / sizeof drifts_ppm[0]; i++) {
        setUp();
        // A seventh of it, at the end.
        const uint32_t cycles = 850000u / (uint32_t)abs_i32(drifts_ppm[i]);
        plant.drift_ppm = drifts_ppm[i];
        run((cycles < 1000u ? cycles : 1000u) * HALF_TICKS);
        TEST_ASSERT_GREATER_THAN_UINT32(0, adapt.trials);
        assert_nothing_learnt();
    }
}

// Of any size, at any time of a trial.
static void test_adapt_does_not_learn_a_step_of_the_excitation(void) {
    const int32_t steps_ppm[] = {-500000, -50000, -21000, -15000, -3000, 3000, 15000, 50000};
    for (uint32_t i = 0; i < sizeof steps_ppm / sizeof steps_ppm[0]; i++) {
        for (uint32_t when = 0; when < ROUND_TICKS; when += 3u * HALF_TICKS) {
            setUp();
            TEST_ASSERT_TRUE(run_until(ADAPT_TRYING, 3 * TRIAL_TICKS));
            run(when);
            plant.excitation_ppm += steps_ppm[i];
            run(2 * ROUND_TICKS);
            assert_nothing_learnt();
        }
    }
}

static void run_until_edge_is_tried(void) {
    for (uint32_t i = 0;
         i < 9u * TRIAL_TICKS && (adapt.state != ADAPT_TRYING || adapt.part != ADAPT_TRY_EDGES);
         i++) {
        tick();
    }
    TEST_ASSERT_EQUAL(ADAPT_TRYING, adapt.state);
}

// A gain of a tenth, and an excitation that grows or falls by a twentieth meanwhile. Thrown away
// means that the same trial is made once more: the direction was not to blame.
static void test_adapt_repeats_a_trial_that_was_disturbed(void) {
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        setUp();
        plant.reach = (bowl_t){{30 * DEGREE_q16, 0, 0}, {400000, 100000, 100000}};
        plant.now_reach_ppm = bowl_ppm(&plant.reach, &plant.trim);
        run_until_edge_is_tried();
        const uint32_t trials = adapt.trials;
        const adapt_trim_t tried = adapt_trim_at(&adapt, aim.index, 0);
        TEST_ASSERT_GREATER_THAN_INT32(0, tried.value[ADAPT_ON_EDGE]);
        TEST_ASSERT_TRUE(run_until(ADAPT_CHECKING, ROUND_TICKS));
        plant.excitation_ppm += sign * 50000;
        TEST_ASSERT_TRUE(run_until(ADAPT_TRYING, TRIAL_TICKS));
        assert_nothing_learnt();
        TEST_ASSERT_EQUAL_UINT32(trials + 1u, adapt.trials);
        const adapt_trim_t again = adapt_trim_at(&adapt, aim.index, 0);
        TEST_ASSERT_EQUAL_INT16_ARRAY(tried.value, again.value, ADAPT_COORDINATES);
        run(2 * ROUND_TICKS);
        TEST_ASSERT_GREATER_THAN_INT32(0, learnt()->value[ADAPT_ON_EDGE]);
    }
}

// --- giving up

static void learn_something(void) {
    plant.reach = (bowl_t){{30 * DEGREE_q16, -30 * DEGREE_q16, -9000}, {300000, 300000, 300000}};
    for (uint32_t i = 0; i < 50u * TRIAL_TICKS && adapt.gains < 4u; i++) {
        tick();
    }
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(4, adapt.gains);
    TEST_ASSERT_TRUE(run_until(ADAPT_TRYING, TRIAL_TICKS));
}

static void assert_trial_is_undone(const adapt_trim_t *before) {
    TEST_ASSERT_EQUAL_MEMORY(before, adapt.trim, sizeof adapt.trim);
    const adapt_trim_t now = adapt_trim_at(&adapt, aim.index, part_q16);
    TEST_ASSERT_EQUAL_INT16_ARRAY(learnt()->value, now.value, ADAPT_COORDINATES);
}

static void test_adapt_trial_changes_one_part(void) {
    const uint32_t parts[] = {1u << ADAPT_WHOLE, 1u << ADAPT_ON_EDGE | 1u << ADAPT_OFF_EDGE,
                              1u << ADAPT_LEVEL};
    uint32_t seen = 0;
    plant.reach = (bowl_t){{20 * DEGREE_q16, -20 * DEGREE_q16, -9000}, {300000, 300000, 300000}};
    for (uint32_t i = 0; i < 100u * TRIAL_TICKS && adapt.state != ADAPT_RESTING; i++) {
        tick();
        const adapt_trim_t now = adapt_trim_at(&adapt, aim.index, 0);
        uint32_t changed = 0;
        for (uint32_t k = 0; k < ADAPT_COORDINATES; k++) {
            changed |= (now.value[k] != learnt()->value[k] ? 1u : 0u) << k;
        }
        TEST_ASSERT_EQUAL_UINT32(adapt.state == ADAPT_TRYING ? parts[adapt.part] : 0u, changed);
        seen |= changed;
    }
    TEST_ASSERT_EQUAL_UINT32((1u << ADAPT_COORDINATES) - 1u, seen);
}

static void test_adapt_fault_keeps_what_was_learnt_and_undoes_the_trial(void) {
    learn_something();
    adapt_trim_t before[ADAPT_POINTS];
    memcpy(before, adapt.trim, sizeof before);
    in.may_try = false;
    tick();
    TEST_ASSERT_EQUAL(ADAPT_WAITING, adapt.state);
    assert_trial_is_undone(before);
    plant.excitation_ppm /= 3;
    run(20 * TRIAL_TICKS);
    TEST_ASSERT_EQUAL(ADAPT_WAITING, adapt.state);
    assert_trial_is_undone(before);
    in.may_try = true;
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 100 * TRIAL_TICKS));
    TEST_ASSERT_LESS_THAN_INT32(WHOLE_ppm + 10000, bowl_ppm(&plant.reach, learnt()));
}

static void test_adapt_pause_in_any_state_undoes_the_trial(void) {
    for (uint32_t ticks = 0; ticks < ROUND_TICKS; ticks += 37u) {
        setUp();
        learn_something();
        run(ticks);
        adapt_trim_t before[ADAPT_POINTS];
        memcpy(before, adapt.trim, sizeof before);
        adapt_pause(&adapt, false);
        TEST_ASSERT_EQUAL(ADAPT_WAITING, adapt.state);
        assert_trial_is_undone(before);
    }
}

// Under a pulse that has just been learnt the lock is lost: it is taken back, once.
static void test_adapt_takes_a_move_back_under_which_the_lock_is_lost(void) {
    plant.reach = (bowl_t){{30 * DEGREE_q16, -30 * DEGREE_q16, 0}, {300000, 300000, 0}};
    TEST_ASSERT_TRUE(run_until(ADAPT_TRYING, 2 * TRIAL_TICKS));
    for (uint32_t i = 0; i < 50u * TRIAL_TICKS && adapt.gains == 0; i++) {
        tick();
    }
    TEST_ASSERT_EQUAL_UINT32(1, adapt.gains);
    TEST_ASSERT_NOT_EQUAL(0, learnt()->value[ADAPT_ON_EDGE]);
    adapt_pause(&adapt, true);
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        TEST_ASSERT_EQUAL_INT16(0, adapt.trim[i].value[ADAPT_ON_EDGE]);
        TEST_ASSERT_EQUAL_INT16(0, adapt.trim[i].value[ADAPT_OFF_EDGE]);
    }
}

// A move that cannot be told from a gain by its corners, and measures worse.
static void test_adapt_takes_a_move_back_that_measures_worse(void) {
    plant.reach = (bowl_t){{30 * DEGREE_q16, 0, 0}, {400000, 0, 0}};
    for (uint32_t i = 0; i < 50u * TRIAL_TICKS && adapt.gains == 0; i++) {
        tick();
    }
    TEST_ASSERT_EQUAL_UINT32(1, adapt.gains);
    plant.reach.best[ADAPT_ON_EDGE] = -30 * DEGREE_q16;
    TEST_ASSERT_EQUAL(ADAPT_CHECKING, adapt.state);
    TEST_ASSERT_TRUE(run_until(ADAPT_MEASURING, TRIAL_TICKS));
    TEST_ASSERT_EQUAL_INT16(0, learnt()->value[ADAPT_ON_EDGE]);
}

// What was tried may be what the lock was lost of.
static void test_adapt_goes_on_with_another_trial_after_a_lost_lock(void) {
    plant.reach = (bowl_t){{30 * DEGREE_q16, 0, 0}, {400000, 100000, 100000}};
    run_until_edge_is_tried();
    const adapt_trim_t tried = adapt_trim_at(&adapt, aim.index, 0);
    adapt_pause(&adapt, true);
    TEST_ASSERT_TRUE(run_until(ADAPT_TRYING, 3 * TRIAL_TICKS));
    const adapt_trim_t next = adapt_trim_at(&adapt, aim.index, 0);
    TEST_ASSERT_FALSE(memcmp(tried.value, next.value, sizeof tried.value) == 0);
    assert_nothing_learnt();
}

static void test_adapt_clear_forgets(void) {
    learn_something();
    adapt_clear(&adapt);
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        const adapt_trim_t zero = {{0}};
        TEST_ASSERT_EQUAL_INT16_ARRAY(zero.value, adapt.trim[i].value, ADAPT_COORDINATES);
    }
    const adapt_trim_t now = adapt_trim_at(&adapt, aim.index, part_q16);
    TEST_ASSERT_EQUAL_INT16(0, now.value[ADAPT_ON_EDGE]);
    TEST_ASSERT_EQUAL(ADAPT_WAITING, adapt.state);
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 100 * TRIAL_TICKS));
    TEST_ASSERT_LESS_THAN_INT32(WHOLE_ppm + 10000, bowl_ppm(&plant.reach, learnt()));
}

// --- frequency

static void test_adapt_gives_up_where_the_frequency_moves_by_2_percent(void) {
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        setUp();
        learn_something();
        adapt_trim_t before[ADAPT_POINTS];
        memcpy(before, adapt.trim, sizeof before);
        const uint32_t trials = adapt.trials + (adapt.part == ADAPT_TRY_LEVEL ? 1u : 0u);
        in.freq_mHz = (uint32_t)(10000 + sign * 190);
        run(SETTLE_TICKS);
        TEST_ASSERT_EQUAL(ADAPT_TRYING, adapt.state);
        in.freq_mHz = (uint32_t)(10000 + sign * 300);
        run(2 * SETTLE_TICKS); // by when it would be measured, and the frequency might be back
        TEST_ASSERT_EQUAL(ADAPT_MEASURING, adapt.state);
        TEST_ASSERT_EQUAL(ADAPT_TRY_WHOLE, adapt.part);
        assert_trial_is_undone(before);
        TEST_ASSERT_EQUAL_UINT32(trials, adapt.trials);
        run(cfg.start_ticks - SETTLE_TICKS); // it must last anew
        TEST_ASSERT_EQUAL(ADAPT_MEASURING, adapt.state);
        TEST_ASSERT_TRUE(run_until(ADAPT_TRYING, TRIAL_TICKS));
    }
}

// A corner may disturb the lock's frequency: it comes back, and the search goes on.
static void test_adapt_goes_on_where_the_frequency_comes_back(void) {
    plant.reach = (bowl_t){{30 * DEGREE_q16, 0, 0}, {400000, 100000, 100000}};
    run_until_edge_is_tried();
    in.freq_mHz = 10500;
    run(SETTLE_TICKS + 1);
    in.freq_mHz = 10000;
    TEST_ASSERT_TRUE(run_until(ADAPT_TRYING, 2 * TRIAL_TICKS));
    TEST_ASSERT_EQUAL(ADAPT_TRY_EDGES, adapt.part);
    TEST_ASSERT_EQUAL(1, adapt.square.corner);
}

// Each half cycle's own frequency is some 1 % off.
static void test_adapt_is_not_misled_by_a_frequency_that_wobbles(void) {
    plant.reach = (bowl_t){{30 * DEGREE_q16, 0, 0}, {400000, 100000, 100000}};
    in.freq_mHz = 10180; // when the search begins
    tick();
    for (uint32_t i = 0; i < 50u * TRIAL_TICKS && adapt.gains < 2u; i++) {
        in.freq_mHz = i / HALF_TICKS % 2u == 0 ? 9850 : 10150;
        tick();
    }
    TEST_ASSERT_EQUAL_UINT32(2, adapt.gains);
}

// Hops between two frequencies, faster than a trial takes.
static void test_adapt_does_not_learn_while_the_frequency_hops(void) {
    plant.reach = (bowl_t){{30 * DEGREE_q16, 0, 0}, {300000, 0, 0}};
    for (uint32_t i = 0; i < 60u; i++) {
        in.freq_mHz = i % 2u == 0 ? 5000 : 20000;
        aim.index = i % 2u == 0 ? 1 : 9;
        run(TRIAL_TICKS / 2);
    }
    assert_nothing_learnt();
}

static void test_adapt_learns_each_frequency_by_itself(void) {
    learn_something();
    const adapt_trim_t first = *learnt();
    aim.index = 20;
    in.freq_mHz = 20000;
    plant.reach = (bowl_t){{-30 * DEGREE_q16, 0, 0}, {300000, 100000, 100000}};
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 100 * TRIAL_TICKS));
    TEST_ASSERT_EQUAL_INT16_ARRAY(first.value, adapt.trim[3].value, ADAPT_COORDINATES);
    TEST_ASSERT_EQUAL_INT16_ARRAY(first.value, adapt.trim[4].value, ADAPT_COORDINATES);
    TEST_ASSERT_LESS_THAN_INT32(-20 * DEGREE_q16, adapt.trim[20].value[ADAPT_ON_EDGE]);
    TEST_ASSERT_LESS_THAN_INT32(-20 * DEGREE_q16, adapt.trim[21].value[ADAPT_ON_EDGE]);
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        if (i != 3u && i != 4u && i != 20u && i != 21u) {
            TEST_ASSERT_EQUAL_INT16(0, adapt.trim[i].value[ADAPT_ON_EDGE]);
        }
    }
}

// The very ends of the largest table.
static void test_adapt_learns_at_the_last_points(void) {
    const uint32_t ends[] = {0, ADAPT_POINTS - 2u};
    for (uint32_t i = 0; i < 2u; i++) {
        setUp();
        aim.index = ends[i];
        part_q16 = 65536u * i;
        learn_something();
        TEST_ASSERT_NOT_EQUAL(0, adapt.trim[ends[i]].value[ADAPT_ON_EDGE]);
        TEST_ASSERT_EQUAL_INT16(adapt.trim[ends[i]].value[ADAPT_ON_EDGE],
                                adapt.trim[ends[i] + 1u].value[ADAPT_ON_EDGE]);
    }
}

static void test_adapt_trim_between_points(void) {
    adapt.trim[5] = (adapt_trim_t){{1000, -16000, -300}};
    adapt.trim[6] = (adapt_trim_t){{-1000, 16000, 0}};
    const struct {
        uint32_t part_q16;
        int32_t expected[ADAPT_COORDINATES];
    } rows[] = {
        {0, {1000, -16000, -300}},
        {32768, {0, 0, -150}},
        {49152, {-500, 8000, -75}},
        {65536, {-1000, 16000, 0}},
    };
    for (uint32_t i = 0; i < 4u; i++) {
        const adapt_trim_t trim = adapt_trim_at(&adapt, 5, rows[i].part_q16);
        for (uint32_t k = 0; k < ADAPT_COORDINATES; k++) {
            TEST_ASSERT_INT32_WITHIN(1, rows[i].expected[k], trim.value[k]);
        }
    }
}

// --- limits

static void test_adapt_allows_what_lies_within_the_limits(void) {
    const int16_t edge = (int16_t)cfg.edge_limit_q16;
    const int16_t level = (int16_t)cfg.level_limit_q15;
    const struct {
        bool is_allowed;
        adapt_trim_t trim;
    } rows[] = {
        {true, {{0, 0, 0}}},
        {true, {{edge, (int16_t)-edge, (int16_t)-level}}},
        {false, {{(int16_t)(edge + 1), 0, 0}}},
        {false, {{(int16_t)(-edge - 1), 0, 0}}},
        {false, {{0, (int16_t)(edge + 1), 0}}},
        {false, {{0, 0, 1}}},
        {false, {{0, 0, (int16_t)(-level - 1)}}},
        {true, {{0, 0, 0, 1}}},
        {false, {{0, 0, 0, 2}}},
        {false, {{0, 0, 0, -1}}},
        {false, {{INT16_MIN, INT16_MIN, INT16_MIN}}},
    };
    for (uint32_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        TEST_ASSERT_EQUAL(rows[i].is_allowed, adapt_is_allowed(&cfg, &rows[i].trim));
    }
}

static void test_adapt_with_limits_of_zero_learns_nothing(void) {
    adapt_cfg_t none = cfg;
    none.edge_limit_q16 = 0;
    none.level_limit_q15 = 0;
    adapt_init(&adapt, &none);
    plant.reach = (bowl_t){{30 * DEGREE_q16, -30 * DEGREE_q16, -9000}, {300000, 300000, 300000}};
    run(30 * TRIAL_TICKS);
    assert_nothing_learnt();
    const adapt_trim_t now = adapt_trim_at(&adapt, aim.index, part_q16);
    TEST_ASSERT_TRUE(adapt_is_allowed(&none, &now));
}

// Anything at all, or a tone that is now and then a little lower: a gain.
static harmonic_sums_t any_half(uint32_t *seed) {
    const uint32_t kind = (uint32_t)abs_i32(signal_noise(seed, 63));
    const int64_t large = INT64_C(1) << kind % 30u;
    if (kind < 60u) {
        return half_of((1 << 20) - (kind < 30u ? 1 << 14 : 0), 0, 1 << 20);
    }
    harmonic_sums_t half = {.ticks = 1u + kind * 64u};
    half.square = (uint64_t)(large * large >> 12) * half.ticks;
    for (uint32_t i = 0; i < HARMONIC_PRODUCTS; i++) {
        half.product[i] = (large * half.ticks >> 10) * signal_noise(seed, 1 << 25);
    }
    return half;
}

static void any_input(uint32_t *seed, const harmonic_sums_t *half) {
    const uint32_t change = (uint32_t)abs_i32(signal_noise(seed, 1000));
    aim = (adapt_aim_t){
        .index = change < 20u ? change * 3u : ADAPT_POINTS - 2u,
        .goal = {change < 500u ? UINT16_MAX : 256u, change < 700u ? UINT16_MAX : 0u,
                 (uint16_t)(change < 100u ? change * 2u : 0u)},
    };
    in = (adapt_in_t){
        .may_try = change > 1u,
        .freq_mHz = change < 5u ? change * 13000u : 10000u,
        .half = change % 3u != 0 ? half : NULL,
    };
}

static void assert_within_limits(const adapt_cfg_t *limits, uint32_t index) {
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        TEST_ASSERT_TRUE(adapt_is_allowed(limits, &adapt.trim[i]));
    }
    for (uint32_t part = 0; part <= 65536u; part += 16384u) {
        adapt_trim_t trim = adapt_trim_at(&adapt, index, part);
        if (adapt.is_free) { // less than the limit allows, down to nothing
            TEST_ASSERT_LESS_OR_EQUAL_INT32(0, trim.value[ADAPT_LEVEL]);
            trim.value[ADAPT_LEVEL] = 0;
        }
        TEST_ASSERT_TRUE(adapt_is_allowed(limits, &trim));
    }
}

static void test_adapt_stays_within_its_limits_whatever_it_sees(void) {
    const adapt_cfg_t quick[] = {
        {0, 0, 1, 0, 16384, 16384},
        {3, 1, 10, 2, 32767, 31129}, // 90 degrees and 95 %
        {0, 2, 1, 5, 1, 1},
    };
    uint32_t seed = 3;
    uint32_t gains = 0;
    for (uint32_t k = 0; k < 3u; k++) {
        adapt_init(&adapt, &quick[k]);
        for (uint32_t i = 0; i < 20000u; i++) {
            const harmonic_sums_t half = any_half(&seed);
            any_input(&seed, &half);
            step();
            if (i % 16u == 0) {
                assert_within_limits(&quick[k], aim.index);
            }
        }
        gains += adapt.gains;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(20, gains);
}

static void test_adapt_counters_saturate(void) {
    adapt.trials = UINT32_MAX - 1u;
    adapt.gains = UINT32_MAX - 1u;
    learn_something(); // by now above four: ends at once
    plant.now_reach_ppm = WHOLE_ppm;
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 150 * TRIAL_TICKS));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, adapt.trials);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, adapt.gains);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_adapt_converges_to_the_best_inside_its_limits);
    RUN_TEST(test_adapt_converges_to_the_limits_where_the_best_is_beyond);
    RUN_TEST(test_adapt_rests_with_nothing_learnt_where_nothing_is_to_gain);
    RUN_TEST(test_adapt_rests_as_long_as_told_then_tries_again);
    RUN_TEST(test_adapt_follows_a_plant_that_changes_while_it_rests);
    RUN_TEST(test_adapt_waits_for_a_vibration_that_lasts);
    RUN_TEST(test_adapt_tries_first_to_close_the_gap_and_opens_it_again);
    RUN_TEST(test_adapt_leaves_the_gap_open_where_that_is_better);
    RUN_TEST(test_adapt_looks_at_the_peak_rather_than_the_fundamental);
    RUN_TEST(test_adapt_measures_reach_and_rms);
    RUN_TEST(test_adapt_measures_the_same_reach_at_any_phase);
    RUN_TEST(test_adapt_leaves_out_the_half_cycle_in_which_it_settled);
    RUN_TEST(test_adapt_weighs_acceleration);
    RUN_TEST(test_adapt_lets_acceleration_go_up_to_its_shape);
    RUN_TEST(test_adapt_does_not_learn_a_drift_of_the_excitation);
    RUN_TEST(test_adapt_does_not_learn_a_step_of_the_excitation);
    RUN_TEST(test_adapt_repeats_a_trial_that_was_disturbed);
    RUN_TEST(test_adapt_trial_changes_one_part);
    RUN_TEST(test_adapt_fault_keeps_what_was_learnt_and_undoes_the_trial);
    RUN_TEST(test_adapt_pause_in_any_state_undoes_the_trial);
    RUN_TEST(test_adapt_takes_a_move_back_under_which_the_lock_is_lost);
    RUN_TEST(test_adapt_takes_a_move_back_that_measures_worse);
    RUN_TEST(test_adapt_goes_on_where_the_frequency_comes_back);
    RUN_TEST(test_adapt_is_not_misled_by_a_frequency_that_wobbles);
    RUN_TEST(test_adapt_goes_on_with_another_trial_after_a_lost_lock);
    RUN_TEST(test_adapt_clear_forgets);
    RUN_TEST(test_adapt_gives_up_where_the_frequency_moves_by_2_percent);
    RUN_TEST(test_adapt_does_not_learn_while_the_frequency_hops);
    RUN_TEST(test_adapt_learns_each_frequency_by_itself);
    RUN_TEST(test_adapt_learns_at_the_last_points);
    RUN_TEST(test_adapt_trim_between_points);
    RUN_TEST(test_adapt_allows_what_lies_within_the_limits);
    RUN_TEST(test_adapt_with_limits_of_zero_learns_nothing);
    RUN_TEST(test_adapt_stays_within_its_limits_whatever_it_sees);
    RUN_TEST(test_adapt_counters_saturate);
    return UNITY_END();
}
