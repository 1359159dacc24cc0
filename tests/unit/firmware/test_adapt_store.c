#include "adapt_store.h"

#include "crc32.h"
#include "test_signal.h"
#include "unity.h"

static const adapt_cfg_t cfg = {
    .measure_ticks = 1, .edge_limit_q16 = 16384, .level_limit_q15 = 31129};
static const adapt_owner_t owner = {.table_crc = 0xCAFE1234u, .setting = 1};

static adapt_t adapt;
static uint32_t words[ADAPT_STORE_WORDS];

void setUp(void) {
    uint32_t seed = 4;
    adapt_init(&adapt, &cfg);
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        adapt.trim[i] = (adapt_trim_t){{
            (int16_t)signal_noise(&seed, 16384),
            (int16_t)signal_noise(&seed, 16384),
            (int16_t)-abs_i32(signal_noise(&seed, 31129)),
            (int16_t)(i % 2u),
        }};
    }
    adapt.trim[1] = (adapt_trim_t){{100, -200, -300}};
    adapt.trim[0] = (adapt_trim_t){{16384, -16384, -31129}};
    adapt.trim[ADAPT_POINTS - 1u] = (adapt_trim_t){{-16384, 16384, 0}};
    adapt_store(&adapt, owner, words);
}
void tearDown(void) {}

static void seal(void) {
    words[1] = crc32_words(&words[2], ADAPT_STORE_WORDS - 2u);
}

static void assert_refused(adapt_owner_t by) {
    adapt_t other;
    adapt_init(&other, &cfg);
    other.trim[7].value[ADAPT_ON_EDGE] = 77;
    other.state = ADAPT_TRYING;
    const adapt_t before = other;
    TEST_ASSERT_FALSE(adapt_restore(&other, by, words));
    TEST_ASSERT_EQUAL_MEMORY(&before, &other, sizeof other);
}

static void test_adapt_store_comes_back_whole(void) {
    adapt_t other;
    adapt_init(&other, &cfg);
    other.state = ADAPT_TRYING;
    other.direction = 1;
    TEST_ASSERT_TRUE(adapt_restore(&other, owner, words));
    TEST_ASSERT_EQUAL_MEMORY(adapt.trim, other.trim, sizeof adapt.trim);
    const adapt_trim_t now = adapt_trim_at(&other, 1, 0); // no trial's change on top
    TEST_ASSERT_EQUAL_INT16_ARRAY(adapt.trim[1].value, now.value, ADAPT_COORDINATES);
}

// A search under way, and where its last move came from, do not outlive it.
static void test_adapt_store_is_not_moved_back(void) {
    adapt_t other;
    adapt_init(&other, &cfg);
    other.state = ADAPT_MEASURING;
    other.index = 1;
    other.moved_index = 1;
    other.from[0] = (adapt_edges_t){5000, -5000};
    other.square.corner = 3;
    TEST_ASSERT_TRUE(adapt_restore(&other, owner, words));
    const adapt_in_t in = {.may_try = true, .freq_mHz = 10000};
    adapt_aim(&other, &(adapt_aim_t){.index = 1});
    for (uint32_t i = 0; i < 3u; i++) {
        adapt_step(&other, &in);
    }
    TEST_ASSERT_EQUAL(ADAPT_MEASURING, other.state);
    adapt_pause(&other, true);
    TEST_ASSERT_EQUAL_MEMORY(adapt.trim, other.trim, sizeof adapt.trim);
    TEST_ASSERT_EQUAL_UINT32(0, other.square.corner);
}

static void test_adapt_store_has_its_version_and_crc(void) {
    TEST_ASSERT_EQUAL_HEX32(ADAPT_STORE_MAGIC, words[0]);
    TEST_ASSERT_EQUAL_HEX32(crc32_words(&words[2], ADAPT_STORE_WORDS - 2u), words[1]);
    TEST_ASSERT_EQUAL_HEX32(owner.table_crc, words[2]);
}

static void test_adapt_store_with_any_bit_flipped_is_refused(void) {
    for (uint32_t bit = 0; bit < 32u * ADAPT_STORE_WORDS; bit += bit < 160u ? 1u : 7u) {
        words[bit / 32u] ^= 1u << bit % 32u;
        assert_refused(owner);
        words[bit / 32u] ^= 1u << bit % 32u;
    }
}

static void test_adapt_store_of_another_table_setting_or_version_is_refused(void) {
    assert_refused((adapt_owner_t){owner.table_crc + 1u, owner.setting});
    assert_refused((adapt_owner_t){owner.table_crc, 0});
    words[0]++;
    assert_refused(owner);
}

static void test_adapt_store_beyond_the_limits_is_refused(void) {
    const adapt_trim_t bad[] = {{{0, 0, 0, 2}},   {{0, 0, 0, -1}}, {{16385, 0, 0}},
                                {{0, -16385, 0}}, {{0, 0, 1}},     {{0, 0, -31130}}};
    const uint32_t points[] = {0, 31, ADAPT_POINTS - 1u};
    for (uint32_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        for (uint32_t k = 0; k < 3u; k++) {
            setUp();
            adapt.trim[points[k]] = bad[i];
            adapt_store(&adapt, owner, words);
            assert_refused(owner);
        }
    }
}

// With a CRC that fits: taken over whole and allowed, or not at all.
static void test_adapt_store_of_any_content_stays_within_the_limits(void) {
    uint32_t seed = 6;
    uint32_t taken = 0;
    for (uint32_t round = 0; round < 300u; round++) {
        setUp();
        for (uint32_t flips = round % 3u; flips > 0; flips--) {
            const uint32_t word = 4u + (uint32_t)abs_i32(signal_noise(&seed, 127));
            words[word] ^= 1u << ((uint32_t)signal_noise(&seed, 31) & 31u);
        }
        seal();
        adapt_t other;
        adapt_init(&other, &cfg);
        if (!adapt_restore(&other, owner, words)) {
            assert_refused(owner);
            continue;
        }
        taken++;
        for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
            TEST_ASSERT_TRUE(adapt_is_allowed(&cfg, &other.trim[i]));
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(100, taken);
    TEST_ASSERT_LESS_THAN_UINT32(300, taken);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_adapt_store_comes_back_whole);
    RUN_TEST(test_adapt_store_is_not_moved_back);
    RUN_TEST(test_adapt_store_has_its_version_and_crc);
    RUN_TEST(test_adapt_store_with_any_bit_flipped_is_refused);
    RUN_TEST(test_adapt_store_of_another_table_setting_or_version_is_refused);
    RUN_TEST(test_adapt_store_beyond_the_limits_is_refused);
    RUN_TEST(test_adapt_store_of_any_content_stays_within_the_limits);
    return UNITY_END();
}
