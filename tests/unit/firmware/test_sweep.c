// The sweep: what it sees, when, and that nothing in itself that flips leads out of its parts.
#include "sweep.h"

#include <string.h>

#include "unity.h"

#define RATE_Hz 1000u
#define OWN 60u
#define TABLE 700u

static sweep_t sweep;
static uint32_t own[OWN];
static uint32_t table[TABLE];

void setUp(void) {
    for (uint32_t i = 0; i < OWN; i++) {
        own[i] = 77u * i;
    }
    for (uint32_t i = 0; i < TABLE; i++) {
        table[i] = ~(i * i);
    }
    sweep_init(&sweep, RATE_Hz);
    sweep_watch(&sweep, 0, own, OWN, own);
    sweep_watch(&sweep, SWEEP_PARTS - 1u, table, TABLE, own);
}
void tearDown(void) {}

// Ticks until it says so, at the most those of two seconds.
static uint32_t ticks_until_seen(void) {
    uint32_t ticks = 1;
    while (ticks < 2 * RATE_Hz && sweep_step(&sweep, own)) {
        ticks++;
    }
    return ticks;
}

static void test_sweep_of_what_stays_is_silent(void) {
    TEST_ASSERT_EQUAL_UINT32(2 * RATE_Hz, ticks_until_seen());
}

static void test_sweep_of_nothing_is_silent(void) {
    sweep_init(&sweep, RATE_Hz);
    TEST_ASSERT_EQUAL_UINT32(2 * RATE_Hz, ticks_until_seen());
}

static void test_sweep_sees_each_bit_within_a_second_whenever_it_flips(void) {
    for (uint32_t bit = 0; bit < 32 * (OWN + TABLE); bit++) {
        uint32_t *word = bit / 32 < OWN ? &own[bit / 32] : &table[bit / 32 - OWN];
        for (uint32_t wait = bit * 37u % 500u; wait > 0; wait--) {
            TEST_ASSERT_TRUE(sweep_step(&sweep, own));
        }
        *word ^= UINT32_C(1) << bit % 32u;
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(RATE_Hz, ticks_until_seen());
        *word ^= UINT32_C(1) << bit % 32u;
        while (sweep.at_part != 0 || sweep.at_word != 0) {
            (void)sweep_step(&sweep, own);
        }
    }
}

static void test_sweep_sees_two_words_changed_against_each_other(void) {
    table[10]++;
    table[20]--;
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(RATE_Hz, ticks_until_seen());
}

static void test_sweep_takes_a_new_part_for_an_old_one(void) {
    static const uint32_t other[] = {1, 2, 3};
    for (uint32_t i = 0; i < 100; i++) {
        (void)sweep_step(&sweep, own);
    }
    sweep_watch(&sweep, SWEEP_PARTS - 1u, other, 3, own);
    table[5]++; // nobody's any more
    TEST_ASSERT_EQUAL_UINT32(2 * RATE_Hz, ticks_until_seen());
    own[3]++;
    sweep_watch(&sweep, 0, own, OWN, own);
    TEST_ASSERT_EQUAL_UINT32(2 * RATE_Hz, ticks_until_seen());
    sweep_watch(&sweep, 0, NULL, 0, own);
    own[3]++;
    TEST_ASSERT_EQUAL_UINT32(2 * RATE_Hz, ticks_until_seen());
}

static void test_sweep_of_a_copy_reads_the_copys_own_words(void) {
    static uint32_t others[OWN];
    memcpy(others, own, sizeof own);
    own[7] = 0xFFFFFFFFu;
    for (uint32_t i = 0; i < 2 * RATE_Hz; i++) {
        TEST_ASSERT_TRUE(sweep_step(&sweep, others));
    }
}

// What is read stays inside of the parts; the sums then differ, and it says so.
static void test_sweep_with_its_own_place_flipped_says_so_or_goes_on(void) {
    for (uint32_t bit = 0; bit < 32; bit++) {
        setUp();
        (void)sweep_step(&sweep, own);
        sweep.at_word ^= UINT32_C(1) << bit;
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(RATE_Hz, ticks_until_seen());
        setUp();
        sweep.at_part ^= UINT32_C(1) << bit;
        (void)ticks_until_seen();
        TEST_ASSERT_LESS_THAN_UINT32(SWEEP_PARTS, sweep.at_part);
    }
}

static void test_sweep_goes_on_with_the_same_words_elsewhere(void) {
    static uint32_t moved[TABLE];
    memcpy(moved, table, sizeof moved);
    sweep_t other;
    sweep_init(&other, RATE_Hz);
    sweep_watch(&other, 0, own, OWN, own);
    sweep_watch(&other, SWEEP_PARTS - 1u, moved, TABLE, own);
    for (uint32_t i = 0; i < 123; i++) {
        TEST_ASSERT_TRUE(sweep_step(&sweep, own));
    }
    TEST_ASSERT_TRUE(sweep_go_on_all(&other, &sweep, 0));
    TEST_ASSERT_EQUAL_UINT32(sweep.at_part, other.at_part);
    TEST_ASSERT_EQUAL_UINT32(sweep.at_word, other.at_word);
    TEST_ASSERT_EQUAL_PTR(moved, other.part[SWEEP_PARTS - 1u].words);
    sweep = other;
    TEST_ASSERT_EQUAL_UINT32(2 * RATE_Hz, ticks_until_seen());
    moved[TABLE - 1u] ^= 1u;
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(RATE_Hz, ticks_until_seen());
}

static void test_sweep_does_not_go_on_with_other_words(void) {
    sweep_t other;
    sweep_init(&other, RATE_Hz);
    sweep_watch(&other, 0, own, OWN, own);
    const sweep_t before = other;
    TEST_ASSERT_FALSE(sweep_go_on_all(&other, &sweep, 0)); // one has no table
    sweep_watch(&other, SWEEP_PARTS - 1u, table + 1, TABLE - 1u, own);
    TEST_ASSERT_FALSE(sweep_go_on_all(&other, &sweep, 0));
    table[3] ^= 4u;
    sweep_watch(&other, SWEEP_PARTS - 1u, table, TABLE, own);
    const sweep_t watching = other;
    TEST_ASSERT_FALSE(sweep_go_on_all(&other, &sweep, 0));
    TEST_ASSERT_EQUAL_MEMORY(&watching, &other, sizeof other);
    TEST_ASSERT_EQUAL_UINT32(before.pass_ticks, other.pass_ticks);
}

static void test_sweep_reads_few_words_a_tick(void) {
    TEST_ASSERT_EQUAL_UINT32((OWN + TABLE) / (RATE_Hz * 9u / 20u - SWEEP_PARTS) + 1u,
                             sweep.words_a_tick);
    sweep_init(&sweep, 500);
    sweep_watch(&sweep, 1, table, TABLE, own);
    TEST_ASSERT_EQUAL_UINT32(TABLE / (500u * 9u / 20u - SWEEP_PARTS) + 1u, sweep.words_a_tick);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_sweep_of_what_stays_is_silent);
    RUN_TEST(test_sweep_of_nothing_is_silent);
    RUN_TEST(test_sweep_sees_each_bit_within_a_second_whenever_it_flips);
    RUN_TEST(test_sweep_sees_two_words_changed_against_each_other);
    RUN_TEST(test_sweep_takes_a_new_part_for_an_old_one);
    RUN_TEST(test_sweep_of_a_copy_reads_the_copys_own_words);
    RUN_TEST(test_sweep_with_its_own_place_flipped_says_so_or_goes_on);
    RUN_TEST(test_sweep_goes_on_with_the_same_words_elsewhere);
    RUN_TEST(test_sweep_does_not_go_on_with_other_words);
    RUN_TEST(test_sweep_reads_few_words_a_tick);
    return UNITY_END();
}
