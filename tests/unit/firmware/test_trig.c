#include "trig.h"

#include "unity.h"

#define ONE_Q30 1073741824
#define GOLDEN 0x9E3779B9u // turns that fill the circle evenly

void setUp(void) {}
void tearDown(void) {}

static void assert_sincos(uint32_t turn, int32_t cos_q30, int32_t sin_q30) {
    const sincos_t at = sincos_q30(turn);
    TEST_ASSERT_INT32_WITHIN(3, cos_q30, at.cos);
    TEST_ASSERT_INT32_WITHIN(3, sin_q30, at.sin);
}

// round(2^30 cos), round(2^30 sin) of turn / 2^32 x 2 pi, computed in double precision.
static void test_sincos_agrees_with_a_reference(void) {
    static const struct {
        uint32_t turn;
        int32_t cos_q30;
        int32_t sin_q30;
    } reference[] = {
        {0x00000001u, 1073741824, 2},           {0x00800000u, 1073660973, 13176464},
        {0x007FFFFFu, 1073660973, 13176462},    {0x00800001u, 1073660973, 13176465},
        {0x01000000u, 1073418433, 26350943},    {0x0AAAAAABu, 1037154958, 277904834},
        {0x15555555u, 929887697, 536870912},    {0x20000000u, 759250125, 759250125},
        {0x2AAAAAABu, 536870912, 929887697},    {0x3FFFFFFFu, 2, 1073741824},
        {0x40000001u, -2, 1073741824},          {0x55555555u, -536870912, 929887697},
        {0x60000000u, -759250125, 759250125},   {0x7F800000u, -1073660973, 13176464},
        {0x7FFFFFFFu, -1073741824, 2},          {0x80000001u, -1073741824, -2},
        {0x95555555u, -929887697, -536870912},  {0xA0000000u, -759250125, -759250125},
        {0xB5C10F3Au, -267178347, -1039969824}, {0xBFFFFFFFu, -2, -1073741824},
        {0xC0000001u, 2, -1073741824},          {0xD2345678u, 463948539, -968335302},
        {0xE0000000u, 759250125, -759250125},   {0xFF7FFFFFu, 1073660973, -13176465},
        {0xFFFFFFFFu, 1073741824, -2},
    };
    for (uint32_t i = 0; i < sizeof reference / sizeof reference[0]; i++) {
        assert_sincos(reference[i].turn, reference[i].cos_q30, reference[i].sin_q30);
    }
}

static void test_sincos_is_exact_at_the_quadrants(void) {
    static const int32_t cosine[] = {ONE_Q30, 0, -ONE_Q30, 0};
    for (uint32_t i = 0; i < 4; i++) {
        const sincos_t at = sincos_q30(i << 30);
        TEST_ASSERT_EQUAL_INT32(cosine[i], at.cos);
        TEST_ASSERT_EQUAL_INT32(cosine[(i + 3u) % 4u], at.sin);
    }
}

static void test_sincos_lies_on_the_unit_circle(void) {
    for (uint32_t i = 0; i < 20000; i++) {
        const sincos_t at = sincos_q30(i * GOLDEN);
        const int64_t square = (int64_t)at.cos * at.cos + (int64_t)at.sin * at.sin;
        // Twice 3.1e-9 of each of them: 8.8e-9 at most.
        TEST_ASSERT_INT32_WITHIN(10, ONE_Q30, (int32_t)(square >> 30));
    }
}

// cos(a + b) and sin(a + b) from those of a and b.
static void test_sincos_obeys_the_addition_theorems(void) {
    for (uint32_t i = 0; i < 20000; i++) {
        const uint32_t a = i * GOLDEN;
        const uint32_t b = i * 0x85EBCA6Bu;
        const sincos_t at_a = sincos_q30(a);
        const sincos_t at_b = sincos_q30(b);
        const sincos_t at_sum = sincos_q30(a + b);
        const int64_t cosine = (int64_t)at_a.cos * at_b.cos - (int64_t)at_a.sin * at_b.sin;
        const int64_t sine = (int64_t)at_a.sin * at_b.cos + (int64_t)at_a.cos * at_b.sin;
        TEST_ASSERT_INT32_WITHIN(13, (int32_t)(cosine >> 30), at_sum.cos);
        TEST_ASSERT_INT32_WITHIN(13, (int32_t)(sine >> 30), at_sum.sin);
    }
}

static void test_linear_cosine_is_within_its_error(void) {
    for (uint32_t i = 0; i < 20000; i++) {
        const uint32_t turn = i * GOLDEN;
        // 7.7e-5 in Q25.
        TEST_ASSERT_INT32_WITHIN(2584, sincos_q30(turn).cos >> 5, cos_linear_q25(turn));
    }
    TEST_ASSERT_EQUAL_INT32((1 << 25) - 1, cos_linear_q25(0));
    TEST_ASSERT_EQUAL_INT32(0, cos_linear_q25(1u << 30));
    TEST_ASSERT_EQUAL_INT32(1 - (1 << 25), cos_linear_q25(1u << 31));
}

static void assert_turn(uint32_t tolerance, uint32_t expected, uint32_t turn) {
    TEST_ASSERT_INT32_WITHIN(tolerance, 0, (int32_t)(turn - expected));
}

static void test_atan2_of_no_vector_is_zero(void) {
    TEST_ASSERT_EQUAL_UINT32(0, atan2_turn(0, 0));
}

static void test_atan2_is_exact_on_the_axes_and_close_on_the_diagonals(void) {
    for (uint32_t bit = 0; bit <= 30; bit++) {
        const int32_t size = 1 << bit;
        TEST_ASSERT_EQUAL_UINT32(0, atan2_turn(0, size));
        TEST_ASSERT_EQUAL_UINT32(1u << 30, atan2_turn(size, 0));
        TEST_ASSERT_EQUAL_UINT32(1u << 31, atan2_turn(0, -size));
        TEST_ASSERT_EQUAL_UINT32(3u << 30, atan2_turn(-size, 0));
        if (bit > 17) {
            assert_turn(43, 1u << 29, atan2_turn(size, size));
            assert_turn(43, 3u << 29, atan2_turn(size, -size));
            assert_turn(43, 5u << 29, atan2_turn(-size, -size));
            assert_turn(43, 7u << 29, atan2_turn(-size, size));
        }
    }
}

// atan2(y, x) / 2 pi x 2^32, computed in double precision; 10^-8 turns are 43.
static void test_atan2_agrees_with_a_reference(void) {
    static const struct {
        int32_t y;
        int32_t x;
        uint32_t turn;
    } reference[] = {
        {300000, 400000, 0x1A37F5C5u},
        {400000, 300000, 0x25C80A3Bu},
        {-300000, 400000, 0xE5C80A3Bu},
        {300000, -400000, 0x65C80A3Bu},
        {-400000, -300000, 0xA5C80A3Bu},
        {131073, 1, 0x3FFFEBA1u},
        {1, 131073, 0x0000145Fu},
        {-1, 131073, 0xFFFFEBA1u},
        {-131073, -65537, 0xAD1BF2BCu},
        {1000000, 1732051, 0x15555534u},
        {123456789, 987654321, 0x051111D3u},
        {987654321, -123456789, 0x451111D3u},
        {-1073741824, 1073741823, 0xE0000000u},
        {1073741823, -1073741824, 0x60000000u},
        {-7, -1073741824, 0x80000004u},
        {620000001, 1000000007, 0x169CD0BEu},
        {-1000000007, 414213565, 0xD0000000u},
    };
    for (uint32_t i = 0; i < sizeof reference / sizeof reference[0]; i++) {
        assert_turn(43, reference[i].turn, atan2_turn(reference[i].y, reference[i].x));
    }
}

static void test_atan2_takes_sincos_back_at_every_length(void) {
    for (uint32_t down = 0; down <= 13; down++) {
        // The vector's components are rounded down, by less than a unit each: 1.42 units across,
        // of 2^(30 - down).
        const uint32_t rounding = (UINT32_C(968000000) >> (30u - down)) + 3u;
        for (uint32_t i = 0; i < 2000; i++) {
            const uint32_t turn = i * GOLDEN;
            const sincos_t at = sincos_q30(turn);
            assert_turn(43u + rounding, turn, atan2_turn(at.sin >> down, at.cos >> down));
        }
    }
}

// A vector turned back by its own angle lies along x: to half a unit, as short as it may be.
static void test_atan2_of_short_vectors_has_their_resolution(void) {
    for (int32_t y = -60; y <= 60; y++) {
        for (int32_t x = -60; x <= 60; x++) {
            if (x == 0 && y == 0) {
                continue;
            }
            const sincos_t at = sincos_q30(atan2_turn(y, x));
            const int64_t along = (int64_t)x * at.cos + (int64_t)y * at.sin;
            const int64_t across = (int64_t)y * at.cos - (int64_t)x * at.sin;
            TEST_ASSERT_TRUE(along >= ONE_Q30 - 8);
            TEST_ASSERT_TRUE(across > -ONE_Q30 / 2 && across < ONE_Q30 / 2);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_sincos_agrees_with_a_reference);
    RUN_TEST(test_sincos_is_exact_at_the_quadrants);
    RUN_TEST(test_sincos_lies_on_the_unit_circle);
    RUN_TEST(test_sincos_obeys_the_addition_theorems);
    RUN_TEST(test_linear_cosine_is_within_its_error);
    RUN_TEST(test_atan2_of_no_vector_is_zero);
    RUN_TEST(test_atan2_is_exact_on_the_axes_and_close_on_the_diagonals);
    RUN_TEST(test_atan2_agrees_with_a_reference);
    RUN_TEST(test_atan2_takes_sincos_back_at_every_length);
    RUN_TEST(test_atan2_of_short_vectors_has_their_resolution);
    return UNITY_END();
}
