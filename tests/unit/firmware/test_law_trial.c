// Every law of the registry with every tracker, on any picture and with tables that were spoilt by
// somebody who knows how to make the checksum right again: no current where the damper would have
// to give power, none beyond what parameters allow.
#include <stddef.h>
#include <string.h>

#include "law_trial.h"
#include "law_words.h"
#include "table.h"
#include "unity.h"

enum { TICKS = 600, SPOILT_TABLES = 60, SPOILT_TICKS = 40, STEADY_TICKS = 50 };

static law_trial_t trial;
static quiesce_params_t params;
static uint32_t words[QUIESCE_TABLE_WORDS];
static uint32_t map[QUIESCE_TABLE_WORDS];
static uint32_t map_count;
static uint32_t count;
static uint32_t seed;

void setUp(void) {
    quiesce_params_default(&params);
    seed = 11;
    count = 0;
}
void tearDown(void) {}

// The law's table: one from here, or a copy of the one that ships. False: its kind has none.
static bool make_table(const law_t *law) {
    count = 0;
    if (law->kind == NULL) {
        return true;
    }
    const law_words_t good = law_words_of(law->kind->magic);
    const uint32_t *from = good.words != NULL ? good.words : law->kind->shipped;
    if (from == NULL) {
        return false;
    }
    count = good.words != NULL ? good.count : from[TABLE_WORDS];
    memcpy(words, from, count * sizeof words[0]);
    law_trial_seal(words, count);
    return true;
}

// Of the tracker's kind.
static void make_map(void) {
    const law_words_t from =
        params.tracker == QUIESCE_TRACKER_BANK ? bank_of_damper : map_of_damper;
    map_count = from.count;
    memcpy(map, from.words, map_count * sizeof map[0]);
    law_trial_seal(map, map_count);
}

static bool start(void) {
    return law_trial_start(&trial, &params, count > 0 ? words : NULL, count, map, map_count, seed);
}

static uint32_t breaks_in(uint32_t ticks) {
    uint32_t breaks = 0;
    for (uint32_t i = 0; i < ticks; i++) {
        law_trial_look(&trial);
        law_trial_step(&trial);
        law_trial_guard(&trial);
        breaks |= law_trial_breaks(&trial);
    }
    return breaks;
}

// Calls one(): with each law whose table can be made here, with each tracker that works with a map
// of a damper or with nothing.
static uint32_t with_each(void (*one)(void)) {
    uint32_t laws = 0;
    for (params.law = 0; law_find(params.law) != NULL; params.law++) {
        const law_t *law = law_find(params.law);
        for (params.tracker = 0; track_find(params.tracker) != NULL; params.tracker++) {
            make_map();
            if (make_table(law) && start()) {
                one();
                laws += params.tracker == 0 ? 1u : 0u;
            }
        }
        params.tracker = 0;
    }
    return laws;
}

static void expect_bounds(void) {
    TEST_ASSERT_EQUAL_HEX32(0, breaks_in(TICKS));
}

static void test_no_law_energises_whatever_it_sees(void) {
    TEST_ASSERT_GREATER_OR_EQUAL(9, with_each(expect_bounds));
}

static void expect_bounds_when_spoilt(void) {
    uint32_t accepted = 0;
    for (uint32_t i = 0; i < SPOILT_TABLES; i++) {
        const bool is_map = count == 0 || i % 2u == 0;
        (void)make_table(law_find(params.law));
        make_map();
        law_trial_spoil(is_map ? map : words, is_map ? map_count : count, &seed);
        if (start()) {
            accepted++;
            TEST_ASSERT_EQUAL_HEX32(0, breaks_in(SPOILT_TICKS));
        }
    }
    TEST_ASSERT_GREATER_THAN(0, accepted);
}

static void test_no_table_that_is_accepted_energises(void) {
    (void)with_each(expect_bounds_when_spoilt);
}

// The rules can be broken: a current against force and velocity is one, a negative one another.
static void test_what_breaks_the_rules_is_seen(void) {
    params.law = QUIESCE_LAW_LINEAR;
    params.tracker = QUIESCE_TRACKER_COMPARE;
    make_map();
    TEST_ASSERT_TRUE(make_table(law_find(params.law)) && start());
    trial.view.damper[1].force_mN = -5;
    trial.demand.value[1] = 7;
    trial.current.value[1] = 1;
    TEST_ASSERT_EQUAL_HEX32(LAW_TRIAL_ENERGISED, law_trial_breaks(&trial));
    trial.view.damper[1].force_mN = 5;
    TEST_ASSERT_EQUAL_HEX32(0, law_trial_breaks(&trial));
    trial.demand.value[1] = 0;
    TEST_ASSERT_EQUAL_HEX32(LAW_TRIAL_ENERGISED, law_trial_breaks(&trial));
    trial.current.value[1] = -1;
    TEST_ASSERT_EQUAL_HEX32(LAW_TRIAL_BEYOND, law_trial_breaks(&trial));
    trial.current.value[1] = 0;
    trial.command.value[0] = params.max_current_mA + 1;
    TEST_ASSERT_EQUAL_HEX32(LAW_TRIAL_BEYOND, law_trial_breaks(&trial));
}

// A spring is judged by its stroke, which may come back against its demand.
static void test_a_spring_breaks_them_by_its_stroke(void) {
    enum { AXIS = TABLE_HEAD_WORDS + 1 };
    params.law = QUIESCE_LAW_LINEAR;
    params.tracker = QUIESCE_TRACKER_INVERSE;
    make_map();
    map[AXIS] = QUIESCE_SENSE_STROKE;
    law_trial_seal(map, map_of_damper.count);
    TEST_ASSERT_TRUE(make_table(law_find(params.law)) && start());
    TEST_ASSERT_EQUAL_HEX32(0, breaks_in(TICKS));
    memset(&trial.current, 0, sizeof trial.current);
    trial.demand.value[1] = 7;
    trial.current.value[1] = 1;
    trial.view.damper[1].stroke_nm = 5;
    trial.view.damper[1].velocity_um_s = -5;
    TEST_ASSERT_EQUAL_HEX32(0, law_trial_breaks(&trial));
    trial.view.damper[1].stroke_nm = -5;
    trial.view.damper[1].velocity_um_s = 5;
    TEST_ASSERT_EQUAL_HEX32(LAW_TRIAL_ENERGISED, law_trial_breaks(&trial));
}

// Through its linear part a stroke's velocity of one sign gets a force of that sign and a current.
static void test_a_trial_reaches_what_it_judges(void) {
    params.law = QUIESCE_LAW_FRICTION;
    params.tracker = QUIESCE_TRACKER_INVERSE;
    make_map();
    TEST_ASSERT_TRUE(make_table(law_find(params.law)) && start());
    uint32_t with_current = 0;
    for (uint32_t i = 0; i < TICKS * STEADY_TICKS; i++) {
        law_trial_look(&trial);
        law_trial_step(&trial);
        with_current += trial.current.value[0] > 0 ? 1u : 0u;
    }
    TEST_ASSERT_GREATER_THAN(TICKS * STEADY_TICKS / 10, with_current);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_no_law_energises_whatever_it_sees);
    RUN_TEST(test_no_table_that_is_accepted_energises);
    RUN_TEST(test_what_breaks_the_rules_is_seen);
    RUN_TEST(test_a_spring_breaks_them_by_its_stroke);
    RUN_TEST(test_a_trial_reaches_what_it_judges);
    return UNITY_END();
}
