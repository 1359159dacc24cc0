#include "stack.h"
#include "unity.h"

static volatile uint32_t initialised = 0x12345678u;
static volatile uint32_t cleared;

void setUp(void) {}
void tearDown(void) {}

static void test_data_is_copied_and_bss_is_zero(void) {
    TEST_ASSERT_EQUAL_HEX32(0x12345678u, initialised);
    TEST_ASSERT_EQUAL_HEX32(0, cleared);
}

__attribute__((noinline)) static uint32_t touch_stack(void) {
    volatile uint32_t block[256];
    for (uint32_t i = 0; i < 256; i++) {
        block[i] = i;
    }
    return block[255];
}

static void test_high_water_follows_the_deepest_call(void) {
    const uint32_t before = stack_high_water_bytes();
    TEST_ASSERT_GREATER_THAN_UINT32(0, before);
    TEST_ASSERT_EQUAL_UINT32(255, touch_stack());
    const uint32_t after = stack_high_water_bytes();
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(1024, after);
    TEST_ASSERT_LESS_THAN_UINT32(before + 1200, after);
    TEST_ASSERT_LESS_THAN_UINT32(stack_size_bytes(), after);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_data_is_copied_and_bss_is_zero);
    RUN_TEST(test_high_water_follows_the_deepest_call);
    return UNITY_END();
}
