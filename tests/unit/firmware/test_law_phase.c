#include <stddef.h>
#include <string.h>

#include "law.h"
#include "phase_state.h"
#include "pulse_words.h"
#include "test_signal.h"
#include "unity.h"

enum { POINTS = 2, UNLOCK_mA = 2500, RATE_Hz = 1000, HALF_TURN_q16 = 65536 };

static const phase_point_t displacement[POINTS] = {
    {.freq_mHz = 5000, .level_mA = 4000, .centre_q16 = 32768, .width_q16 = 32768, .floor_mA = 1000},
    {.freq_mHz = 10000, .level_mA = 3000, .centre_q16 = 8192, .width_q16 = 16384, .floor_mA = 200},
};
static const phase_point_t balanced[POINTS] = {
    {.freq_mHz = 5000, .level_mA = 1500, .width_q16 = PHASE_WIDTH_ALL, .floor_mA = 1500},
    {.freq_mHz = 10000, .level_mA = 1700, .width_q16 = PHASE_WIDTH_ALL, .floor_mA = 1700},
};

static uint32_t words[PHASE_TABLE_MAX_WORDS];
static law_setup_t setup;
static quiesce_params_t *const params = &setup.params;
static phase_t state;
static view_t view;
static view_tone_t *const tone = &view.tone;
static harmonic_sums_t half;

extern const law_t law_phase;

static void set_lock(bool is_on) {
    view.valid = VIEW_RMS | (is_on ? VIEW_LOCK : 0);
}

static void start(void) {
    pulse_words_make(words, displacement, POINTS, balanced, POINTS);
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, table_check(law_phase.kind, words, words[2]));
    setup.table = words;
    memset(&state, 0, sizeof state);
    law_phase.init(&state, &setup);
}

void setUp(void) {
    quiesce_params_default(params);
    params->tick_rate_Hz = RATE_Hz;
    params->unlock_current_mA = UNLOCK_mA;
    params->phase_setting = QUIESCE_PHASE_SETTING_DISPLACEMENT;
    params->phase_blend_ms = 0;
    params->adapt = QUIESCE_ADAPT_OFF;
    view = (view_t){.is_output_on = true, .may_learn = true};
    set_lock(true);
    start();
}
void tearDown(void) {}

static int32_t request(void) {
    law_demand_t demand;
    TEST_ASSERT_TRUE(law_phase.step(&state, &setup, &view, &demand));
    return demand.value[0];
}

static void lock_at(uint32_t freq_mHz) {
    tone->step_turn = (uint32_t)(((uint64_t)freq_mHz << 32) / (1000u * RATE_Hz));
}

// Half a cycle of a steady vibration ends where twice the phase wraps.
static int32_t tick(void) {
    const uint32_t before = tone->phase_turn << 1;
    tone->phase_turn += tone->step_turn;
    const uint32_t ticks = (UINT32_C(1) << 31) / tone->step_turn;
    half = (harmonic_sums_t){
        .ticks = ticks,
        .product = {INT64_C(1000000) * 16384 * ticks},
        .square = UINT64_C(500000000000) / 4096u * ticks,
    };
    tone->half = tone->phase_turn << 1 < before ? &half : NULL;
    return request();
}

static void run(uint32_t ticks) {
    for (; ticks > 0; ticks--) {
        tick();
    }
}

// The request at a phase of the next tick's beginning, modulo half a turn.
static int32_t request_at(uint32_t phase_q16) {
    tone->phase_turn = (phase_q16 << 15) - tone->step_turn;
    tone->half = NULL;
    return request();
}

// Where a request rises from floor to level and falls again, to a 512th of half a turn.
typedef struct {
    uint32_t on_q16, off_q16;
    int32_t highest_mA, lowest_mA;
} shape_t;

static shape_t shape_of_request(void) {
    shape_t shape = {0, 0, INT32_MIN, INT32_MAX};
    for (uint32_t q16 = 0; q16 < HALF_TURN_q16; q16 += 128u) {
        const int32_t current_mA = request_at(q16);
        shape.highest_mA = current_mA > shape.highest_mA ? current_mA : shape.highest_mA;
        shape.lowest_mA = current_mA < shape.lowest_mA ? current_mA : shape.lowest_mA;
    }
    const int32_t middle_mA = (shape.highest_mA + shape.lowest_mA) / 2;
    const uint32_t half_tick_q16 = tone->step_turn >> 16; // a tick's middle, of half a turn
    for (uint32_t q16 = 0; q16 < HALF_TURN_q16; q16 += 128u) {
        const bool is_on = request_at(q16) > middle_mA;
        const bool was_on = request_at(q16 - 128u) > middle_mA;
        shape.on_q16 = is_on && !was_on ? q16 + half_tick_q16 : shape.on_q16;
        shape.off_q16 = !is_on && was_on ? q16 + half_tick_q16 : shape.off_q16;
    }
    return shape;
}

static void assert_edge(uint32_t expected_q16, uint32_t q16) {
    TEST_ASSERT_INT32_WITHIN(300, 0, (int16_t)(uint16_t)(expected_q16 - q16));
}

// --- request

static void test_law_phase_unlocked_requests_its_constant(void) {
    lock_at(5000);
    set_lock(false);
    for (uint32_t i = 0; i < 300u; i++) {
        TEST_ASSERT_EQUAL_INT32(UNLOCK_mA, tick());
    }
    set_lock(true);
    view.is_output_on = false;
    for (uint32_t i = 0; i < 300u; i++) {
        TEST_ASSERT_EQUAL_INT32(UNLOCK_mA, tick());
    }
}

// The narrow current is for who asks for acceleration, at work, while nothing is locked on to.
static void test_law_phase_unlocked_in_a_narrow_band(void) {
    params->narrow_current_mA = 500;
    params->safe_current_mA = 70;
    set_lock(false);
    tone->is_narrow = true;
    TEST_ASSERT_EQUAL_INT32(UNLOCK_mA, request());
    params->phase_setting = QUIESCE_PHASE_SETTING_BALANCED;
    TEST_ASSERT_EQUAL_INT32(500, request());
    view.is_at_rest = true;
    TEST_ASSERT_EQUAL_INT32(70, request());
    view.is_at_rest = false;
    tone->is_narrow = false;
    TEST_ASSERT_EQUAL_INT32(UNLOCK_mA, request());
}

static void test_law_phase_requests_the_tables_pulse(void) {
    lock_at(5000);
    run(300);
    const shape_t slow = shape_of_request();
    TEST_ASSERT_EQUAL_INT32(4000, slow.highest_mA);
    TEST_ASSERT_EQUAL_INT32(1000, slow.lowest_mA);
    assert_edge(16384, slow.on_q16);
    assert_edge(49152, slow.off_q16);
    lock_at(10000); // a pulse that begins at the wrap
    run(300);
    const shape_t fast = shape_of_request();
    TEST_ASSERT_EQUAL_INT32(3000, fast.highest_mA);
    TEST_ASSERT_EQUAL_INT32(200, fast.lowest_mA);
    assert_edge(0, fast.on_q16);
    assert_edge(16384, fast.off_q16);
}

// As where a table is exchanged while the lock is on.
static void test_law_phase_first_tick_with_a_lock_has_its_pulse(void) {
    params->phase_setting = QUIESCE_PHASE_SETTING_BALANCED;
    start();
    lock_at(5000);
    TEST_ASSERT_EQUAL_INT32(1500, tick());
    TEST_ASSERT_EQUAL_UINT32(4999, state.freq_mHz);
}

static void test_law_phase_follows_the_frequency_between_points(void) {
    lock_at(7500);
    run(300);
    const shape_t shape = shape_of_request();
    TEST_ASSERT_INT32_WITHIN(1, 3500, shape.highest_mA);
    TEST_ASSERT_INT32_WITHIN(1, 600, shape.lowest_mA);
    assert_edge(20480 - 12288, shape.on_q16);
    assert_edge(20480 + 12288, shape.off_q16);
}

static void test_law_phase_beyond_the_table_uses_its_ends(void) {
    const uint32_t freqs_mHz[] = {1000, 4900, 10100, 50000};
    const int32_t highest_mA[] = {4000, 4000, 3000, 3000};
    for (uint32_t i = 0; i < 4u; i++) {
        lock_at(freqs_mHz[i]);
        run(2000);
        TEST_ASSERT_EQUAL_INT32(highest_mA[i], shape_of_request().highest_mA);
    }
}

// The current that a tick holds is the mean over it: half a cycle's is the pulse's own, to the
// rounding of its two edges.
static void test_law_phase_mean_current_is_the_pulses(void) {
    lock_at(9973);
    run(1000);
    int64_t sum_mA = 0;
    for (uint32_t i = 0; i < 10000u; i++) {
        sum_mA += tick();
    }
    // Next to 10 Hz: a quarter of the time 3000, else 200, plus 0.54 % of what 5 Hz differs by.
    TEST_ASSERT_INT32_WITHIN(20, 900 + 8, (int32_t)(sum_mA / 10000));
}

static void test_law_phase_uses_its_setting(void) {
    params->phase_setting = QUIESCE_PHASE_SETTING_BALANCED;
    start();
    lock_at(7500);
    run(300);
    for (uint32_t q16 = 0; q16 < HALF_TURN_q16; q16 += 1000u) {
        TEST_ASSERT_INT32_WITHIN(1, 1600, request_at(q16));
    }
}

// --- blend

static void test_law_phase_fades_in_and_lets_go_with_the_lock(void) {
    params->phase_setting = QUIESCE_PHASE_SETTING_BALANCED; // constant: 1500 mA
    params->phase_blend_ms = 200;
    start();
    lock_at(5000);
    for (uint32_t round = 0; round < 3u; round++) {
        int32_t last_mA = UNLOCK_mA;
        for (int32_t i = 1; i <= 200; i++) {
            const int32_t current_mA = tick();
            TEST_ASSERT_INT32_WITHIN(8, UNLOCK_mA - 1000 * i / 200, current_mA);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(last_mA, current_mA);
            last_mA = current_mA;
        }
        tick();
        TEST_ASSERT_EQUAL_INT32(1500, tick());
        set_lock(false);
        TEST_ASSERT_EQUAL_INT32(UNLOCK_mA, request());
        set_lock(true);
    }
}

// A tick of the safe current does not cost the pulses; a long one does.
static void test_law_phase_fades_out_while_the_output_is_off(void) {
    params->phase_setting = QUIESCE_PHASE_SETTING_BALANCED; // constant: 1500 mA
    params->phase_blend_ms = 200;
    start();
    lock_at(5000);
    run(300);
    TEST_ASSERT_EQUAL_INT32(1500, tick());
    static const int32_t off_ms[] = {1, 50, 199, 1000};
    for (uint32_t i = 0; i < sizeof off_ms / sizeof *off_ms; i++) {
        view.is_output_on = false;
        for (int32_t k = 0; k < off_ms[i]; k++) {
            TEST_ASSERT_EQUAL_INT32(UNLOCK_mA, tick());
        }
        view.is_output_on = true;
        const int32_t faded_ms = off_ms[i] < 200 ? off_ms[i] : 200;
        TEST_ASSERT_INT32_WITHIN(20, 1500 + 1000 * faded_ms / 200, tick());
        run(300);
        TEST_ASSERT_EQUAL_INT32(1500, tick());
    }
}

static void test_law_phase_fades_in_as_long_at_any_tick_rate(void) {
    const int32_t rates_Hz[] = {500, 1000, 2000, 4000};
    params->phase_setting = QUIESCE_PHASE_SETTING_BALANCED;
    for (uint32_t i = 0; i < 4u; i++) {
        const int32_t blends_ms[] = {20, 500, 10000};
        for (uint32_t k = 0; k < 3u; k++) {
            params->tick_rate_Hz = rates_Hz[i];
            params->phase_blend_ms = blends_ms[k];
            start();
            lock_at(1000);
            const int32_t ticks = blends_ms[k] * rates_Hz[i] / 1000;
            run((uint32_t)(ticks * 8 / 10)); // its step is rounded up: 8.2 s for 10 s at 4 kHz
            TEST_ASSERT_LESS_THAN_UINT32(65536, state.blend_q16);
            run((uint32_t)(ticks / 5 + 2));
            TEST_ASSERT_EQUAL_UINT32(65536, state.blend_q16);
        }
    }
}

// --- trims

static void learn(int32_t on_q16, int32_t off_q16, int32_t level_q15) {
    for (uint32_t i = 0; i < POINTS; i++) {
        state.adapt.trim[i] =
            (adapt_trim_t){{(int16_t)on_q16, (int16_t)off_q16, (int16_t)level_q15}};
    }
}

static bool has_trim(void) {
    bool has = false;
    for (uint32_t i = 0; i < ADAPT_COORDINATES; i++) {
        has = has || state.trim.value[i] != 0;
    }
    return has;
}

static shape_t shape_with(int32_t on_q16, int32_t off_q16, int32_t level_q15) {
    params->adapt = QUIESCE_ADAPT_FROZEN;
    start();
    learn(on_q16, off_q16, level_q15);
    lock_at(5000);
    run(300);
    return shape_of_request();
}

static void test_law_phase_moves_the_right_edge(void) {
    const int32_t moves_q16[] = {4000, -4000, 12000, -12000};
    for (uint32_t i = 0; i < 4u; i++) {
        const shape_t first = shape_with(moves_q16[i], 0, 0);
        assert_edge((uint32_t)(16384 + moves_q16[i]), first.on_q16);
        assert_edge(49152, first.off_q16);
        const shape_t last = shape_with(0, moves_q16[i], 0);
        assert_edge(16384, last.on_q16);
        assert_edge((uint32_t)(49152 + moves_q16[i]), last.off_q16);
        TEST_ASSERT_EQUAL_INT32(4000, last.highest_mA);
        TEST_ASSERT_EQUAL_INT32(1000, last.lowest_mA);
    }
    const shape_t wrapped = shape_with(-20000, 4000, 0);
    assert_edge((uint32_t)(16384 - 20000), wrapped.on_q16);
    assert_edge(49152 + 4000, wrapped.off_q16);
}

static void test_law_phase_lowers_the_level_but_not_below_its_floor(void) {
    TEST_ASSERT_INT32_WITHIN(1, 3000, shape_with(0, 0, -8192).highest_mA);
    TEST_ASSERT_EQUAL_INT32(1000, shape_with(0, 0, -8192).lowest_mA);
    TEST_ASSERT_EQUAL_INT32(1000, shape_with(0, 0, -31129).highest_mA);
    TEST_ASSERT_EQUAL_INT32(1000, shape_with(0, 0, -31129).lowest_mA);
}

static void test_law_phase_pulse_closes_and_opens_fully(void) {
    const shape_t closed = shape_with(20000, -20000, 0);
    TEST_ASSERT_EQUAL_INT32(1000, closed.highest_mA);
    TEST_ASSERT_EQUAL_INT32(1000, closed.lowest_mA);
    const shape_t open = shape_with(-20000, 20000, 0);
    TEST_ASSERT_EQUAL_INT32(4000, open.highest_mA);
    TEST_ASSERT_EQUAL_INT32(4000, open.lowest_mA);
}

static void test_law_phase_without_a_gap(void) {
    params->adapt = QUIESCE_ADAPT_FROZEN;
    start();
    for (uint32_t i = 0; i < POINTS; i++) {
        state.adapt.trim[i] = (adapt_trim_t){{9000, -9000, -8192, 1}};
    }
    lock_at(5000);
    run(300);
    const shape_t shape = shape_of_request();
    TEST_ASSERT_EQUAL_INT32(3000, shape.highest_mA);
    TEST_ASSERT_EQUAL_INT32(3000, shape.lowest_mA);
}

// --- adaptation

static void make_adapt_quick(int32_t mode) {
    params->adapt = mode;
    params->adapt_start_ms = 100;
    params->adapt_settle_ms = 50;
    params->adapt_measure_ms = 50;
    params->phase_accel_floor_pct = -100;
    start();
}

static void test_law_phase_adapt_off_ignores_what_was_learnt(void) {
    make_adapt_quick(QUIESCE_ADAPT_OFF);
    learn(4000, 4000, -8192);
    lock_at(5000);
    run(3000);
    TEST_ASSERT_EQUAL(ADAPT_WAITING, state.adapt.state);
    TEST_ASSERT_FALSE(has_trim());
    const shape_t shape = shape_of_request();
    assert_edge(16384, shape.on_q16);
    assert_edge(49152, shape.off_q16);
    TEST_ASSERT_EQUAL_INT32(4000, shape.highest_mA);
}

static void assert_only_uses_what_it_has_learnt(void) {
    learn(4000, -4000, -8192);
    lock_at(5000);
    for (uint32_t i = 0; i < 3000u; i++) {
        tick();
        TEST_ASSERT_EQUAL(ADAPT_WAITING, state.adapt.state);
    }
    TEST_ASSERT_EQUAL_UINT32(0, state.adapt.trials);
    const adapt_trim_t expected = {{4000, -4000, -8192}};
    TEST_ASSERT_EQUAL_INT16_ARRAY(expected.value, state.trim.value, ADAPT_COORDINATES);
    TEST_ASSERT_INT32_WITHIN(1, 3000, shape_of_request().highest_mA);
}

static void test_law_phase_adapt_frozen_tries_nothing(void) {
    make_adapt_quick(QUIESCE_ADAPT_FROZEN);
    assert_only_uses_what_it_has_learnt();
    make_adapt_quick(QUIESCE_ADAPT_ON);
    view.may_learn = false;
    assert_only_uses_what_it_has_learnt();
}

static void test_law_phase_adapt_on_tries(void) {
    make_adapt_quick(QUIESCE_ADAPT_ON);
    lock_at(5000);
    bool has_tried = false;
    for (uint32_t i = 0; i < 9000u; i++) {
        tick();
        has_tried = has_tried || has_trim();
    }
    TEST_ASSERT_TRUE(has_tried);
    TEST_ASSERT_GREATER_THAN_UINT32(2, state.adapt.trials);
    TEST_ASSERT_EQUAL_UINT32(0, state.adapt.gains); // nothing that it did mattered
}

static void run_to_a_trial(void) {
    for (uint32_t i = 0; i < 3000u && state.adapt.state != ADAPT_TRYING; i++) {
        tick();
    }
    run(150); // the next half cycle takes the change
}

static void test_law_phase_lost_lock_or_fault_undoes_the_trial(void) {
    for (uint32_t i = 0; i < 2u; i++) {
        make_adapt_quick(QUIESCE_ADAPT_ON);
        params->adapt_settle_ms = 1000;
        start();
        lock_at(5000);
        run_to_a_trial();
        TEST_ASSERT_TRUE(has_trim());
        set_lock(i == 1u);
        view.is_output_on = i == 0;
        tick();
        TEST_ASSERT_EQUAL(ADAPT_WAITING, state.adapt.state);
        set_lock(true);
        view.is_output_on = true;
        tick();
        TEST_ASSERT_FALSE(has_trim());
        assert_edge(16384, shape_of_request().on_q16);
    }
}

static void test_law_phase_does_not_try_while_it_fades_in(void) {
    make_adapt_quick(QUIESCE_ADAPT_ON);
    params->phase_blend_ms = 2000;
    start();
    lock_at(5000);
    run(1950);
    TEST_ASSERT_EQUAL(ADAPT_WAITING, state.adapt.state);
    run(52);
    TEST_ASSERT_EQUAL(ADAPT_MEASURING, state.adapt.state);
}

// Whatever phase, frequency and sums it is told: between the lowest and the highest of all.
static void test_law_phase_request_is_bounded_for_any_input(void) {
    make_adapt_quick(QUIESCE_ADAPT_ON);
    uint32_t seed = 8;
    lock_at(5000);
    for (uint32_t i = 0; i < 30000u; i++) {
        const int32_t kind = abs_i32(signal_noise(&seed, 2000));
        set_lock(kind != 0);
        view.is_output_on = kind != 1;
        if (kind < 20) {
            lock_at(1000u + (uint32_t)abs_i32(signal_noise(&seed, 59000)));
            tone->phase_turn = seed;
        }
        const int32_t current_mA = tick();
        TEST_ASSERT_TRUE(current_mA >= 200 && current_mA <= 4000);
        TEST_ASSERT_TRUE(adapt_is_allowed(&state.adapt.cfg, &state.trim));
    }
    TEST_ASSERT_GREATER_THAN_UINT32(0, state.adapt.trials);
}

// Setting displacement measures acceleration without current: not even a floor current flows.
static void test_law_phase_with_a_floor_tries_no_current(void) {
    make_adapt_quick(QUIESCE_ADAPT_ON);
    params->phase_accel_floor_pct = -1;
    start();
    lock_at(5000);
    int32_t lowest_mA = INT32_MAX;
    for (uint32_t i = 0; i < 9000u; i++) {
        const int32_t current_mA = tick();
        lowest_mA = current_mA < lowest_mA ? current_mA : lowest_mA;
    }
    TEST_ASSERT_EQUAL_INT32(0, lowest_mA);
    params->phase_setting = 1; // balanced has no floor
    start();
    lock_at(5000);
    for (uint32_t i = 0; i < 9000u; i++) {
        TEST_ASSERT_GREATER_THAN_INT32(0, tick());
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_law_phase_unlocked_requests_its_constant);
    RUN_TEST(test_law_phase_unlocked_in_a_narrow_band);
    RUN_TEST(test_law_phase_requests_the_tables_pulse);
    RUN_TEST(test_law_phase_first_tick_with_a_lock_has_its_pulse);
    RUN_TEST(test_law_phase_follows_the_frequency_between_points);
    RUN_TEST(test_law_phase_beyond_the_table_uses_its_ends);
    RUN_TEST(test_law_phase_mean_current_is_the_pulses);
    RUN_TEST(test_law_phase_uses_its_setting);
    RUN_TEST(test_law_phase_fades_in_and_lets_go_with_the_lock);
    RUN_TEST(test_law_phase_fades_out_while_the_output_is_off);
    RUN_TEST(test_law_phase_fades_in_as_long_at_any_tick_rate);
    RUN_TEST(test_law_phase_moves_the_right_edge);
    RUN_TEST(test_law_phase_lowers_the_level_but_not_below_its_floor);
    RUN_TEST(test_law_phase_pulse_closes_and_opens_fully);
    RUN_TEST(test_law_phase_without_a_gap);
    RUN_TEST(test_law_phase_adapt_off_ignores_what_was_learnt);
    RUN_TEST(test_law_phase_adapt_frozen_tries_nothing);
    RUN_TEST(test_law_phase_adapt_on_tries);
    RUN_TEST(test_law_phase_lost_lock_or_fault_undoes_the_trial);
    RUN_TEST(test_law_phase_does_not_try_while_it_fades_in);
    RUN_TEST(test_law_phase_request_is_bounded_for_any_input);
    RUN_TEST(test_law_phase_with_a_floor_tries_no_current);
    return UNITY_END();
}
