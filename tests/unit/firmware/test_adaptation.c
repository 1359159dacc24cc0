// The phase law's table and what it has learnt, from outside the controller.
#include <string.h>

#include "adapt_store.h"
#include "plant_pulses.h"
#include "pulse_words.h"
#include "quiesce.h"
#include "test_signal.h"
#include "unity.h"

static quiesce_t controller;
static quiesce_params_t params;
static quiesce_out_t out;
static quiesce_adaptation_t kept;
static uint32_t ticks;
static uint32_t seed;
static uint32_t words[PHASE_TABLE_MAX_WORDS];

static void start(void) {
    ticks = 0;
    seed = 1;
    TEST_ASSERT_TRUE(quiesce_init(&controller, &params));
}

void setUp(void) {
    quiesce_params_default(&params);
    params.law = QUIESCE_LAW_PHASE;
    params.phase_blend_ms = 0;
    params.adapt_start_ms = 0;
    params.adapt_settle_ms = 50;
    params.adapt_measure_ms = 50;
    params.adapt_edge_limit_mdeg = 45000;
    params.adapt_level_limit_pct = 50;
    start();
}
void tearDown(void) {}

// 0.3 m/s2 at 10 Hz in 0.5 mg of noise. Returns whether the adaptation did anything.
static bool vibrate(uint32_t count) {
    bool has_adapted = false;
    for (; count > 0; count--) {
        const quiesce_in_t in = {
            .tick = ticks,
            .accel_counts = signal_sine(5195, 10000, ticks, 1000) + signal_noise(&seed, 147),
            .accel_is_fresh = true,
            .enable = true,
        };
        quiesce_step(&controller, &in, &out);
        ticks++;
        has_adapted = has_adapted || out.telemetry.adapt_state != QUIESCE_ADAPT_WAITING;
    }
    return has_adapted;
}

// As if it had been learnt, at every point.
static void learnt_before(uint32_t table_crc, uint32_t setting, adapt_trim_t trim) {
    adapt_t adapt = {0};
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        adapt.trim[i] = trim;
    }
    adapt_store(&adapt, (adapt_owner_t){table_crc, setting}, kept.words);
}

static uint32_t shipped_crc(void) {
    return plant_pulses_table[1];
}

static const adapt_trim_t trim = {{1820, -3640, -8192, 0}}; // 5 and -10 degrees, 3/4

static void make_other_table(void) {
    const phase_point_t points[] = {
        {.freq_mHz = 5000, .level_mA = 1234, .width_q16 = PHASE_WIDTH_ALL, .floor_mA = 1234},
        {.freq_mHz = 20000, .level_mA = 1234, .width_q16 = PHASE_WIDTH_ALL, .floor_mA = 1234},
    };
    pulse_words_make(words, points, 2, points, 2);
}

static void test_adaptation_is_saved_loaded_and_in_effect(void) {
    params.adapt = QUIESCE_ADAPT_FROZEN;
    start();
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_ADAPTATION_WORDS, ADAPT_STORE_WORDS);
    TEST_ASSERT_TRUE(quiesce_adaptation_load(&controller, &kept));
    quiesce_adaptation_t again;
    quiesce_adaptation_save(&controller, &again);
    TEST_ASSERT_EQUAL_MEMORY(&kept, &again, sizeof kept);
    TEST_ASSERT_FALSE(vibrate(2500));
    TEST_ASSERT_EQUAL_UINT32(1, out.telemetry.lock_is_on);
    TEST_ASSERT_INT32_WITHIN(10, 5000, out.telemetry.trim_on_mdeg);
    TEST_ASSERT_INT32_WITHIN(10, -10000, out.telemetry.trim_off_mdeg);
    TEST_ASSERT_INT32_WITHIN(1, 32768 - 8192, out.telemetry.trim_level_q15);
    quiesce_adaptation_save(&controller, &again); // still
    TEST_ASSERT_EQUAL_MEMORY(&kept, &again, sizeof kept);
}

static void test_adaptation_reset_forgets(void) {
    params.adapt = QUIESCE_ADAPT_FROZEN;
    start();
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    TEST_ASSERT_TRUE(quiesce_adaptation_load(&controller, &kept));
    vibrate(1500);
    quiesce_adaptation_reset(&controller);
    vibrate(200);
    TEST_ASSERT_EQUAL_INT32(0, out.telemetry.trim_on_mdeg);
    TEST_ASSERT_EQUAL_INT32(32768, out.telemetry.trim_level_q15);
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, (adapt_trim_t){{0}});
    quiesce_adaptation_t again;
    quiesce_adaptation_save(&controller, &again);
    TEST_ASSERT_EQUAL_MEMORY(&kept, &again, sizeof kept);
}

static void assert_load_refused(void) {
    quiesce_t before = controller;
    TEST_ASSERT_FALSE(quiesce_adaptation_load(&controller, &kept));
    TEST_ASSERT_EQUAL_MEMORY(&before, &controller, sizeof before);
}

static void test_adaptation_of_something_else_is_refused(void) {
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_DISPLACEMENT, trim);
    assert_load_refused();
    learnt_before(shipped_crc() + 1u, QUIESCE_PHASE_SETTING_BALANCED, trim);
    assert_load_refused();
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    kept.words[QUIESCE_ADAPTATION_WORDS - 1u] ^= 1u;
    assert_load_refused();
    params.adapt_level_limit_pct = 20;
    start();
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    assert_load_refused();
}

static void test_adaptation_belongs_to_its_table(void) {
    make_other_table();
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    TEST_ASSERT_TRUE(quiesce_adaptation_load(&controller, &kept));
    TEST_ASSERT_EQUAL(QUIESCE_PHASE_OK, quiesce_phase_table_use(&controller, words, words[2]));
    assert_load_refused();
    quiesce_adaptation_t now;
    quiesce_adaptation_save(&controller, &now);
    learnt_before(words[1], QUIESCE_PHASE_SETTING_BALANCED, (adapt_trim_t){{0}});
    TEST_ASSERT_EQUAL_MEMORY(&kept, &now, sizeof now); // cleared
    TEST_ASSERT_EQUAL(QUIESCE_PHASE_OK, quiesce_phase_table_use(&controller, NULL, 0));
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    TEST_ASSERT_TRUE(quiesce_adaptation_load(&controller, &kept));
}

static void test_phase_table_of_the_user_is_used_while_running(void) {
    params.adapt = QUIESCE_ADAPT_OFF;
    start();
    make_other_table();
    vibrate(2000);
    TEST_ASSERT_EQUAL_UINT32(1, out.telemetry.lock_is_on);
    TEST_ASSERT_EQUAL(QUIESCE_PHASE_OK, quiesce_phase_table_use(&controller, words, words[2]));
    for (uint32_t i = 0; i < 200u; i++) { // from the first tick on
        vibrate(1);
        TEST_ASSERT_EQUAL_INT32(1234, out.telemetry.current_law_mA);
    }
    start();
    vibrate(2000);
    TEST_ASSERT_NOT_EQUAL(1234, out.telemetry.current_law_mA);
}

static void test_phase_table_that_is_refused_changes_nothing(void) {
    make_other_table();
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    TEST_ASSERT_TRUE(quiesce_adaptation_load(&controller, &kept));
    const uint32_t count = words[2];
    const quiesce_t before = controller;
    words[6] ^= 1u;
    TEST_ASSERT_EQUAL(QUIESCE_PHASE_CRC, quiesce_phase_table_use(&controller, words, count));
    TEST_ASSERT_EQUAL(QUIESCE_PHASE_SIZE, quiesce_phase_table_use(&controller, words, count - 1u));
    words[0]++;
    TEST_ASSERT_EQUAL(QUIESCE_PHASE_MAGIC, quiesce_phase_table_use(&controller, words, count));
    make_other_table();
    words[3] = 1u | 3u << 16;
    pulse_words_seal(words, count);
    TEST_ASSERT_EQUAL(QUIESCE_PHASE_SHAPE, quiesce_phase_table_use(&controller, words, count));
    make_other_table();
    words[PULSE_WORDS_HEADER] = words[PULSE_WORDS_HEADER + PULSE_WORDS_POINT];
    pulse_words_seal(words, count);
    TEST_ASSERT_EQUAL(QUIESCE_PHASE_POINT, quiesce_phase_table_use(&controller, words, count));
    TEST_ASSERT_EQUAL_MEMORY(&before, &controller, sizeof before);
}

static void test_adaptation_frozen_stays_so_until_it_is_told_otherwise(void) {
    TEST_ASSERT_TRUE(vibrate(2500)); // it would
    start();
    quiesce_adaptation_freeze(&controller, true);
    TEST_ASSERT_FALSE(vibrate(2500));
    make_other_table();
    TEST_ASSERT_EQUAL(QUIESCE_PHASE_OK, quiesce_phase_table_use(&controller, words, words[2]));
    TEST_ASSERT_FALSE(vibrate(1000));
    quiesce_adaptation_reset(&controller);
    TEST_ASSERT_FALSE(vibrate(1000));
    quiesce_adaptation_freeze(&controller, false);
    TEST_ASSERT_TRUE(vibrate(1000));
}

// Parameters that are refused leave a controller that can still be asked.
static void test_adaptation_of_a_refused_controller(void) {
    params.tick_rate_Hz = 3;
    TEST_ASSERT_FALSE(quiesce_init(&controller, &params));
    quiesce_adaptation_save(&controller, &kept);
    TEST_ASSERT_TRUE(quiesce_adaptation_load(&controller, &kept));
    quiesce_adaptation_reset(&controller);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_adaptation_is_saved_loaded_and_in_effect);
    RUN_TEST(test_adaptation_reset_forgets);
    RUN_TEST(test_adaptation_of_something_else_is_refused);
    RUN_TEST(test_adaptation_belongs_to_its_table);
    RUN_TEST(test_phase_table_of_the_user_is_used_while_running);
    RUN_TEST(test_phase_table_that_is_refused_changes_nothing);
    RUN_TEST(test_adaptation_frozen_stays_so_until_it_is_told_otherwise);
    RUN_TEST(test_adaptation_of_a_refused_controller);
    return UNITY_END();
}
