// The image's output stage on fakes: the current loop's interrupt, the tick, and what cuts it off.
#include "board.h"
#include "cycles.h"
#include "fake_break.h"
#include "fake_registers.h"
#include "nvic.h"
#include "output.h"
#include "stm32f4_adc.h"
#include "stm32f4_interrupts.h"
#include "stm32f4_tim1.h"
#include "unity.h"
#include "vectors.h"

#define TIM(r) fake_get(TIM1_BASE + (r))
#define NO_CURRENT 1551u
#define SUPPLY_12V 1354u
#define COUNT_mA 16u
#define A_TICK 10 ///< steps of the current loop

const stm32f4_board_t stm32f4_board = {
    .drive_enable = PIN_B(10),
    .output = OUTPUT_BRIDGE,
    .bridge = {.pwm = PIN_A(8),
               .cut_off = PIN_B(12),
               .current = PIN_A(0),
               .supply = PIN_A(1),
               .current_channel = 0,
               .supply_channel = 1,
               .current_zero_counts = 1551,
               .current_uA_a_count = 16000,
               .supply_uV_a_count = 8865},
    .loop = {.resistance_mohm = 5000,
             .gain_mV_a_mA_q8 = 12800,
             .integral_time_us = 20000,
             .integral_mV = 8000,
             .full_scale_mA = 5000},
};
uint32_t fake_nvic_enabled[8];
int32_t fake_nvic_held;
static uint32_t cycles_now;
static uint32_t cycles_a_call;
static quiesce_driver_t driver;

uint32_t cycles_count(void) {
    cycles_now += cycles_a_call;
    return cycles_now;
}

static void watch(uint32_t address, bool is_write, uint32_t value) {
    (void)address;
    (void)is_write;
    (void)value;
    fake_break_behave();
}

static void measure_counts(uint32_t current, uint32_t supply) {
    fake_set(ADC1_BASE + ADC_JDR1, current);
    fake_set(ADC1_BASE + ADC_JDR2, supply);
}

void setUp(void) {
    const clocks_t clocks = {.source = CLOCK_CRYSTAL, .apb2_timer_Hz = 168000000u};
    fake_reset(FAKE_F405);
    fake_break_reset();
    fake_use_hook(watch);
    output_open(&clocks);
    measure_counts(NO_CURRENT, SUPPLY_12V);
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
    TEST_ASSERT_EQUAL_INT32(0, fake_nvic_held);
}

// As main does: the interrupt's steps, what they have found, the command.
static void tick(int32_t current_mA, bool is_enabled) {
    for (int i = 0; i < A_TICK; i++) {
        interrupt_current();
    }
    output_measure(&driver);
    output_write(current_mA, is_enabled);
    TEST_ASSERT_TRUE(output_is_alive());
}

static void test_a_fault_line_that_stays_low_ends_it_and_holds_up_nothing(void) {
    tick(1000, true);
    tick(1000, true);
    TEST_ASSERT_FALSE(driver.has_failed);
    TEST_ASSERT_TRUE(TIM(TIM1_CCR1) > 0u);
    fake_break_line(true);
    for (int i = 0; i < 5; i++) {
        tick(1000, true);
        TEST_ASSERT_TRUE(driver.has_failed);
        TEST_ASSERT_EQUAL_UINT32(0, TIM(TIM1_CCR1));
        // An interrupt that is enabled and whose flag stays would run for ever.
        TEST_ASSERT_EQUAL_HEX32(0, TIM(TIM1_DIER) & TIM(TIM1_SR));
    }
    tick(0, false);
    tick(0, false);
    TEST_ASSERT_FALSE(driver.has_failed); // off: whoever acknowledges gets on
    tick(1000, true);
    tick(1000, true);
    TEST_ASSERT_TRUE(driver.has_failed);
    fake_break_line(false);
    tick(1000, true); // it does not come on by itself
    TEST_ASSERT_TRUE(driver.has_failed);
    TEST_ASSERT_EQUAL_UINT32(0, TIM(TIM1_BDTR) & TIM1_BDTR_MOE);
    tick(0, false);
    tick(1000, true);
    tick(1000, true);
    TEST_ASSERT_FALSE(driver.has_failed);
    TEST_ASSERT_TRUE(TIM(TIM1_CCR1) > 0u);
}

static void test_an_interrupt_that_stays_away_is_a_failure(void) {
    tick(1000, true);
    TEST_ASSERT_FALSE(driver.has_failed);
    TEST_ASSERT_TRUE(driver.is_measured);
    output_measure(&driver);
    TEST_ASSERT_FALSE(driver.is_measured);
    TEST_ASSERT_FALSE(driver.has_failed); // between two steps, after a late tick
    TEST_ASSERT_FALSE(output_is_alive());
    output_measure(&driver);
    TEST_ASSERT_TRUE(driver.has_failed);
    tick(1000, true);
    TEST_ASSERT_FALSE(driver.has_failed);
    output_measure(&driver);
    TEST_ASSERT_FALSE(driver.has_failed); // one at a time does not add up
}

// A resistor in the coil's place: what flows after a step follows from its duty.
static bool fails_within(uint32_t ticks, uint32_t resistance_mohm, int32_t command_mA) {
    bool has_failed = false;
    tick(command_mA, true);
    for (uint32_t i = 0; i < ticks && !has_failed; i++) {
        for (int j = 0; j < A_TICK; j++) {
            const uint32_t voltage_mV = 12000u * TIM(TIM1_CCR1) / (TIM(TIM1_ARR) + 1u);
            measure_counts(NO_CURRENT + voltage_mV * 1000u / resistance_mohm / COUNT_mA,
                           SUPPLY_12V);
            interrupt_current();
        }
        output_measure(&driver);
        output_write(command_mA, true);
        has_failed = driver.has_failed;
    }
    return has_failed;
}

static void test_a_coil_that_is_open_or_short_is_a_failure(void) {
    static const struct {
        uint32_t resistance_mohm;
        int32_t command_mA;
        bool fails;
    } cases[] = {{5000, 1000, false},   {6500, 1000, false}, {5000, 0, false},   {5000, 100, false},
                 {1000000, 1000, true}, {800, 1000, true},   {1800, 1000, false}};
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        setUp();
        tick(0, false);
        TEST_ASSERT_EQUAL(cases[i].fails,
                          fails_within(400, cases[i].resistance_mohm, cases[i].command_mA));
        output_write(0, false);
        tick(0, false);
        TEST_ASSERT_FALSE(driver.has_failed); // off: whoever acknowledges gets on
    }
}

static void test_only_the_current_interrupts(void) {
    TEST_ASSERT_EQUAL_HEX32(1u << ADC_INTERRUPT, fake_nvic_enabled[0]);
    TEST_ASSERT_EQUAL_HEX32(0, fake_nvic_enabled[1] | fake_nvic_enabled[2]);
}

static void test_the_longest_interrupt_is_told_once(void) {
    static const struct {
        uint32_t now, taken;
    } rows[] = {{0, 70}, {1000, 90}, {UINT32_MAX - 100u, 60}, {0, 0}}; // one with a wrap
    (void)output_longest_cycles();
    for (uint32_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        cycles_now = rows[i].now;
        cycles_a_call = rows[i].taken;
        tick(1000, true);
    }
    TEST_ASSERT_EQUAL_UINT32(90, output_longest_cycles());
    TEST_ASSERT_EQUAL_UINT32(0, output_longest_cycles());
    cycles_a_call = 20;
    tick(1000, true);
    TEST_ASSERT_EQUAL_UINT32(20, output_longest_cycles());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_fault_line_that_stays_low_ends_it_and_holds_up_nothing);
    RUN_TEST(test_the_longest_interrupt_is_told_once);
    RUN_TEST(test_an_interrupt_that_stays_away_is_a_failure);
    RUN_TEST(test_a_coil_that_is_open_or_short_is_a_failure);
    RUN_TEST(test_only_the_current_interrupts);
    return UNITY_END();
}
