// The limit of acceleration: measured without current, kept, given up.
#include "adapt_plant.h"

enum { FREE_rms_ppm = 1300000, LIMIT_pct = 101 }; // of that without current

// Later edges reach less but shake more; without current it shakes as much as 24 degrees later do.
static void limit_acceleration(void) {
    plant.reach = (bowl_t){{40 * DEGREE_q16, 0, 0}, {100000, 100000, 100000}};
    plant.rms = (bowl_t){{-10 * DEGREE_q16, 0, 0}, {500000, 0, 0}};
    plant.free_rms_ppm = FREE_rms_ppm;
    aim.goal = (adapt_goal_t){0, 0, LIMIT_pct};
}

static bool is_without_current(void) {
    return adapt_trim_at(&adapt, aim.index, 0).value[ADAPT_LEVEL] == ADAPT_NO_CURRENT;
}

static void test_adapt_measures_acceleration_without_current_once(void) {
    limit_acceleration();
    uint32_t trials = 0;
    bool was_free = false;
    for (uint32_t i = 0; i < 100u * TRIAL_TICKS && adapt.state != ADAPT_RESTING; i++) {
        tick();
        trials += is_without_current() && !was_free ? 1u : 0u;
        was_free = is_without_current();
    }
    TEST_ASSERT_EQUAL(ADAPT_RESTING, adapt.state);
    TEST_ASSERT_EQUAL_UINT32(1, trials);
    TEST_ASSERT_UINT32_WITHIN(FREE_rms_ppm / 200, FREE_rms_ppm, adapt.free_rms_um_s2);
}

// The current fades: a lock does not follow a jump.
static void test_adapt_takes_the_current_away_little_by_little(void) {
    limit_acceleration();
    int32_t last = 0;
    for (uint32_t i = 0; i < 3u * TRIAL_TICKS && !is_without_current(); i++) {
        tick();
        const int32_t now = adapt_trim_at(&adapt, aim.index, 0).value[ADAPT_LEVEL];
        TEST_ASSERT_TRUE(now <= last && now >= last - 32768 / (int32_t)SETTLE_TICKS - 1);
        last = now;
    }
    TEST_ASSERT_TRUE(is_without_current());
}

// The fade starts at the level that is learnt: nothing gets more current than before.
static void test_adapt_fades_from_the_level_that_is_learnt(void) {
    limit_acceleration();
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        adapt.trim[i].value[ADAPT_LEVEL] = -9000;
    }
    for (uint32_t i = 0; i < 3u * TRIAL_TICKS && !is_without_current(); i++) {
        tick();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(
            -9000, adapt_trim_at(&adapt, aim.index, part_q16).value[ADAPT_LEVEL]);
    }
    TEST_ASSERT_TRUE(is_without_current());
}

static void test_adapt_spends_acceleration_up_to_its_limit(void) {
    limit_acceleration();
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 150 * TRIAL_TICKS));
    const int32_t limit_ppm = FREE_rms_ppm / 100 * 101;
    const int32_t rms_ppm = bowl_ppm(&plant.rms, learnt());
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limit_ppm + limit_ppm / 200, rms_ppm);
    TEST_ASSERT_GREATER_THAN_INT32(15 * DEGREE_q16, learnt()->value[ADAPT_ON_EDGE]);
    setUp();
    limit_acceleration();
    aim.goal.accel_limit_pct = 0; // none
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 150 * TRIAL_TICKS));
    TEST_ASSERT_GREATER_THAN_INT32(30 * DEGREE_q16, learnt()->value[ADAPT_ON_EDGE]);
}

// A pulse that starts far above its limit comes below it, whatever that takes.
static void test_adapt_comes_back_below_its_limit(void) {
    limit_acceleration();
    plant.rms.best[ADAPT_ON_EDGE] = -40 * DEGREE_q16;
    plant.rms.rise_ppm[ADAPT_ON_EDGE] = 900000;
    TEST_ASSERT_TRUE(run_until(ADAPT_RESTING, 150 * TRIAL_TICKS));
    const int32_t limit_ppm = FREE_rms_ppm / 100 * 101;
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limit_ppm + limit_ppm / 200, bowl_ppm(&plant.rms, learnt()));
}

// An excitation that never stays the same: the limit follows it, and one trial without current is
// all that a search makes.
static void test_adapt_does_without_current_once_however_the_excitation_changes(void) {
    limit_acceleration();
    uint32_t trials = 0;
    bool was_free = false;
    for (uint32_t i = 0; i < 60u * TRIAL_TICKS && adapt.state != ADAPT_RESTING; i++) {
        if (i % (5u * TRIAL_TICKS) == 5u * TRIAL_TICKS - 1u) {
            plant.excitation_ppm = plant.excitation_ppm / 100 * 108;
        }
        tick();
        trials += is_without_current() && !was_free ? 1u : 0u;
        was_free = is_without_current();
    }
    TEST_ASSERT_EQUAL_UINT32(1, trials);
    const uint32_t free_um_s2 =
        (uint32_t)((uint64_t)FREE_rms_ppm * (uint32_t)plant.excitation_ppm / (uint32_t)WHOLE_ppm);
    TEST_ASSERT_UINT32_WITHIN(free_um_s2 / 8u, free_um_s2, adapt.free_rms_um_s2);
}

// Where the lock does not hold without current, nothing shakes more than before.
static void test_adapt_gives_trials_without_current_up(void) {
    limit_acceleration();
    uint32_t lost = 0;
    for (uint32_t i = 0; i < 150u * TRIAL_TICKS && adapt.state != ADAPT_RESTING; i++) {
        tick();
        if (is_without_current()) {
            adapt_pause(&adapt, true);
            TEST_ASSERT_FALSE(is_without_current());
            lost++;
        }
    }
    TEST_ASSERT_EQUAL(ADAPT_RESTING, adapt.state);
    TEST_ASSERT_EQUAL_UINT32(2, lost);
    const int32_t start_ppm = bowl_ppm(&plant.rms, &(adapt_trim_t){{0}});
    TEST_ASSERT_LESS_OR_EQUAL_INT32(start_ppm / 100 * 102, bowl_ppm(&plant.rms, learnt()));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_adapt_measures_acceleration_without_current_once);
    RUN_TEST(test_adapt_takes_the_current_away_little_by_little);
    RUN_TEST(test_adapt_fades_from_the_level_that_is_learnt);
    RUN_TEST(test_adapt_spends_acceleration_up_to_its_limit);
    RUN_TEST(test_adapt_comes_back_below_its_limit);
    RUN_TEST(test_adapt_does_without_current_once_however_the_excitation_changes);
    RUN_TEST(test_adapt_gives_trials_without_current_up);
    return UNITY_END();
}
