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
static int32_t report[QUIESCE_REPORT_WORDS];
enum { ADAPT_STATE = 0, TRIM_ON_mdeg = 3, TRIM_OFF_mdeg = 4, TRIM_LEVEL_q15 = 5 };
static quiesce_learnt_t kept;
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
            .sensor[0].counts = signal_sine(5195, 10000, ticks, 1000) + signal_noise(&seed, 147),
            .sensor[0].is_fresh = true,
            .enable = ticks > 0, // its edge arms
        };
        quiesce_step(&controller, &in, &out);
        ticks++;
        quiesce_report(&controller, report);
        has_adapted = has_adapted || report[ADAPT_STATE] != ADAPT_WAITING;
    }
    return has_adapted;
}

// As if it had been learnt, at every point.
static void learnt_before(uint32_t table_crc, uint32_t setting, adapt_trim_t trim) {
    adapt_t adapt = {0};
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        adapt.trim[i] = trim;
    }
    kept = (quiesce_learnt_t){.count = ADAPT_STORE_WORDS};
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
    TEST_ASSERT_TRUE(quiesce_learnt_load(&controller, &kept));
    quiesce_learnt_t again;
    (void)quiesce_learnt_save(&controller, &again);
    TEST_ASSERT_EQUAL_MEMORY(&kept, &again, sizeof kept);
    TEST_ASSERT_FALSE(vibrate(2500));
    TEST_ASSERT_EQUAL_UINT32(1, out.telemetry.lock_is_on);
    TEST_ASSERT_INT32_WITHIN(10, 5000, report[TRIM_ON_mdeg]);
    TEST_ASSERT_INT32_WITHIN(10, -10000, report[TRIM_OFF_mdeg]);
    TEST_ASSERT_INT32_WITHIN(1, 32768 - 8192, report[TRIM_LEVEL_q15]);
    (void)quiesce_learnt_save(&controller, &again); // still
    TEST_ASSERT_EQUAL_MEMORY(&kept, &again, sizeof kept);
}

static void test_adaptation_reset_forgets(void) {
    params.adapt = QUIESCE_ADAPT_FROZEN;
    start();
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    TEST_ASSERT_TRUE(quiesce_learnt_load(&controller, &kept));
    vibrate(1500);
    TEST_ASSERT_TRUE(quiesce_learnt_load(&controller, NULL));
    vibrate(200);
    TEST_ASSERT_EQUAL_INT32(0, report[TRIM_ON_mdeg]);
    TEST_ASSERT_EQUAL_INT32(32768, report[TRIM_LEVEL_q15]);
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, (adapt_trim_t){{0}});
    quiesce_learnt_t again;
    (void)quiesce_learnt_save(&controller, &again);
    TEST_ASSERT_EQUAL_MEMORY(&kept, &again, sizeof kept);
}

static void assert_load_refused(void) {
    quiesce_t before = controller;
    TEST_ASSERT_FALSE(quiesce_learnt_load(&controller, &kept));
    TEST_ASSERT_EQUAL_MEMORY(&before, &controller, sizeof before);
}

static void test_adaptation_of_something_else_is_refused(void) {
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_DISPLACEMENT, trim);
    assert_load_refused();
    learnt_before(shipped_crc() + 1u, QUIESCE_PHASE_SETTING_BALANCED, trim);
    assert_load_refused();
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    kept.words[ADAPT_STORE_WORDS - 1u] ^= 1u;
    assert_load_refused();
    params.adapt_level_limit_pct = 20;
    start();
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    assert_load_refused();
}

static void test_adaptation_belongs_to_its_table(void) {
    make_other_table();
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    TEST_ASSERT_TRUE(quiesce_learnt_load(&controller, &kept));
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, quiesce_table_use(&controller, words, words[2]));
    assert_load_refused();
    quiesce_learnt_t now;
    (void)quiesce_learnt_save(&controller, &now);
    learnt_before(words[1], QUIESCE_PHASE_SETTING_BALANCED, (adapt_trim_t){{0}});
    TEST_ASSERT_EQUAL_MEMORY(&kept, &now, sizeof now); // cleared
    TEST_ASSERT_TRUE(quiesce_table_drop(&controller, QUIESCE_OF_LAW));
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    TEST_ASSERT_TRUE(quiesce_learnt_load(&controller, &kept));
}

static void test_phase_table_of_the_user_is_used_while_running(void) {
    params.adapt = QUIESCE_ADAPT_OFF;
    start();
    make_other_table();
    vibrate(2000);
    TEST_ASSERT_EQUAL_UINT32(1, out.telemetry.lock_is_on);
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, quiesce_table_use(&controller, words, words[2]));
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
    TEST_ASSERT_TRUE(quiesce_learnt_load(&controller, &kept));
    const uint32_t count = words[2];
    const quiesce_t before = controller;
    words[6] ^= 1u;
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_CRC, quiesce_table_use(&controller, words, count));
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_SIZE, quiesce_table_use(&controller, words, count - 1u));
    words[0]++;
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_MAGIC, quiesce_table_use(&controller, words, count));
    make_other_table();
    words[3] = 1u | 3u << 16;
    pulse_words_seal(words, count);
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_SHAPE, quiesce_table_use(&controller, words, count));
    make_other_table();
    words[PULSE_WORDS_HEADER] = words[PULSE_WORDS_HEADER + PULSE_WORDS_POINT];
    pulse_words_seal(words, count);
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_POINT, quiesce_table_use(&controller, words, count));
    TEST_ASSERT_EQUAL_MEMORY(&before, &controller, sizeof before);
}

static void test_adaptation_frozen_stays_so_until_it_is_told_otherwise(void) {
    TEST_ASSERT_TRUE(vibrate(2500)); // it would
    start();
    quiesce_learnt_freeze(&controller, true);
    TEST_ASSERT_FALSE(vibrate(2500));
    make_other_table();
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, quiesce_table_use(&controller, words, words[2]));
    TEST_ASSERT_FALSE(vibrate(1000));
    TEST_ASSERT_TRUE(quiesce_learnt_load(&controller, NULL));
    TEST_ASSERT_FALSE(vibrate(1000));
    quiesce_learnt_freeze(&controller, false);
    TEST_ASSERT_TRUE(vibrate(1000));
}

static void test_adaptation_report_has_names(void) {
    const quiesce_word_t *names = quiesce_report_words(QUIESCE_LAW_PHASE);
    TEST_ASSERT_EQUAL_STRING("adapt_state", names[ADAPT_STATE].name);
    TEST_ASSERT_EQUAL_STRING("trim_on_mdeg", names[TRIM_ON_mdeg].name);
    TEST_ASSERT_EQUAL_STRING("mdeg", names[TRIM_OFF_mdeg].unit);
    TEST_ASSERT_EQUAL_STRING("trim_level_q15", names[TRIM_LEVEL_q15].name);
    TEST_ASSERT_NULL(names[7].name);
    TEST_ASSERT_NULL(quiesce_report_words(QUIESCE_LAW_OFF)[0].name);
    TEST_ASSERT_NULL(quiesce_report_words(-1));
}

// A law without a table, and one that learns nothing.
static void test_adaptation_of_another_law(void) {
    make_other_table();
    learnt_before(words[1], QUIESCE_PHASE_SETTING_BALANCED, trim);
    params.law = QUIESCE_LAW_FUZZY;
    start();
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_MAGIC, quiesce_table_use(&controller, words, words[2]));
    assert_load_refused();
    TEST_ASSERT_TRUE(quiesce_learnt_load(&controller, NULL));
    params.law = QUIESCE_LAW_OFF;
    start();
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_MAGIC, quiesce_table_use(&controller, words, words[2]));
    TEST_ASSERT_FALSE(quiesce_table_drop(&controller, QUIESCE_OF_LAW));
    TEST_ASSERT_FALSE(quiesce_learnt_save(&controller, &kept));
    TEST_ASSERT_EQUAL_UINT32(0, kept.count);
}

static void test_learnt_of_no_length_is_refused(void) {
    learnt_before(shipped_crc(), QUIESCE_PHASE_SETTING_BALANCED, trim);
    const uint32_t counts[] = {0, 1, ADAPT_STORE_WORDS - 1u, ADAPT_STORE_WORDS + 1u, UINT32_MAX};
    for (uint32_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        kept.count = counts[i];
        assert_load_refused();
    }
}

// Parameters that are refused leave a controller that can still be asked: law fuzzy's.
static void test_adaptation_of_a_refused_controller(void) {
    params.tick_rate_Hz = 3;
    TEST_ASSERT_FALSE(quiesce_init(&controller, &params));
    TEST_ASSERT_FALSE(quiesce_learnt_save(&controller, &kept));
    TEST_ASSERT_FALSE(quiesce_learnt_load(&controller, &kept));
    TEST_ASSERT_TRUE(quiesce_learnt_load(&controller, NULL));
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
    RUN_TEST(test_adaptation_report_has_names);
    RUN_TEST(test_adaptation_of_another_law);
    RUN_TEST(test_learnt_of_no_length_is_refused);
    return UNITY_END();
}
