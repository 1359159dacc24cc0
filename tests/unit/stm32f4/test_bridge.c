// The bridge and the DAC on fakes: what is driven, and what cuts it off.
#include "bridge.h"
#include "dac.h"
#include "fake_break.h"
#include "fake_registers.h"
#include "stm32f4_adc.h"
#include "stm32f4_adc_common.h"
#include "stm32f4_dac.h"
#include "stm32f4_gpio.h"
#include "stm32f4_rcc.h"
#include "stm32f4_tim1.h"
#include "unity.h"

#define TIMER_Hz 168000000u
#define TIM(r) fake_get(TIM1_BASE + (r))

static const bridge_wiring_t wiring = {
    .pwm = PIN_A(8),
    .cut_off = PIN_B(12),
    .current = PIN_A(0),
    .supply = PIN_C(3),
    .current_channel = 0,
    .supply_channel = 13,
    .current_zero_counts = 1551,
    .current_uA_a_count = 16000,
    .supply_uV_a_count = 8865,
};
static bridge_t bridge;
static bool pwm_drives_before_it_is_off;

static void watch(uint32_t address, bool is_write, uint32_t value) {
    (void)value;
    fake_break_behave();
    if (is_write && address == GPIOA_BASE + GPIO_MODER && (fake_get(address) >> 16 & 3u) == 2u) {
        pwm_drives_before_it_is_off = (TIM(TIM1_BDTR) & TIM1_BDTR_OSSI) == 0u;
    }
}

void setUp(void) {
    fake_reset(FAKE_F446);
    fake_break_reset();
    fake_use_hook(watch);
    bridge_open(&bridge, &wiring, TIMER_Hz);
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
}

static void test_it_opens_switched_off_with_its_break_armed(void) {
    TEST_ASSERT_FALSE(pwm_drives_before_it_is_off);
    TEST_ASSERT_FALSE(bridge_is_on());
    TEST_ASSERT_BITS_HIGH(TIM1_BDTR_BKE | TIM1_BDTR_OSSI | TIM1_BDTR_OSSR, TIM(TIM1_BDTR));
    TEST_ASSERT_BITS_LOW(TIM1_BDTR_AOE | TIM1_BDTR_BKP, TIM(TIM1_BDTR)); // low cuts, for good
    TEST_ASSERT_BITS_LOW(1u << 8, TIM(TIM1_CR2));                        // OIS1: idles low
    TEST_ASSERT_EQUAL_UINT32(0, TIM(TIM1_CCR1));
    TEST_ASSERT_EQUAL_HEX32(0, TIM(TIM1_DIER));      // no interrupt whose flag nothing can clear
    TEST_ASSERT_BITS_LOW(TIM1_SR_BIF, TIM(TIM1_SR)); // the pin is the timer's before that looks
}

static void test_the_periods_are_20_kHz_and_every_second_one_measures(void) {
    TEST_ASSERT_EQUAL_UINT32(TIMER_Hz, (TIM(TIM1_ARR) + 1u) * BRIDGE_PWM_HZ);
    TEST_ASSERT_EQUAL_UINT32(1, TIM(TIM1_RCR));
    TEST_ASSERT_EQUAL_UINT32(2, (TIM(TIM1_CR2) & TIM1_CR2_MMS) >> TIM1_CR2_MMS_AT);
    const uint32_t cr2 = fake_get(ADC1_BASE + ADC_CR2);
    TEST_ASSERT_EQUAL_UINT32(1, (cr2 & ADC_CR2_JEXTSEL) >> ADC_CR2_JEXTSEL_AT);
    TEST_ASSERT_EQUAL_UINT32(1, (cr2 & ADC_CR2_JEXTEN) >> ADC_CR2_JEXTEN_AT);
    TEST_ASSERT_BITS_HIGH(ADC_CR1_SCAN | ADC_CR1_JEOCIE, fake_get(ADC1_BASE + ADC_CR1));
    // Two conversions of 28 + 12 cycles each, at 21 MHz, are done long before the next ones.
    TEST_ASSERT_EQUAL_UINT32(1, fake_get(ADC_COMMON_BASE + ADC_COMMON_CCR) >> 16 & 3u);
    TEST_ASSERT_EQUAL_UINT32(2, fake_get(ADC1_BASE + ADC_SMPR2) & 7u);
    TEST_ASSERT_EQUAL_UINT32(2, fake_get(ADC1_BASE + ADC_SMPR1) >> 9 & 7u);
}

static void test_what_is_measured_has_its_scales(void) {
    const uint32_t jsqr = fake_get(ADC1_BASE + ADC_JSQR);
    TEST_ASSERT_EQUAL_UINT32(1, (jsqr & ADC_JSQR_JL) >> ADC_JSQR_JL_AT);
    TEST_ASSERT_EQUAL_UINT32(0, (jsqr & ADC_JSQR_JSQ3) >> ADC_JSQR_JSQ3_AT);
    TEST_ASSERT_EQUAL_UINT32(13, (jsqr & ADC_JSQR_JSQ4) >> ADC_JSQR_JSQ4_AT);
    fake_set(ADC1_BASE + ADC_JDR1, 1551u + 125u);
    fake_set(ADC1_BASE + ADC_JDR2, 2707);
    fake_set(ADC1_BASE + ADC_SR, ADC_SR_JEOC | ADC_SR_JSTRT | ADC_SR_OVR);
    const bridge_measured_t measured = bridge_take(&bridge);
    TEST_ASSERT_EQUAL_INT32(2000, measured.current_mA);
    TEST_ASSERT_EQUAL_INT32(23997, measured.supply_mV);
    TEST_ASSERT_EQUAL_HEX32(ADC_SR_OVR, fake_get(ADC1_BASE + ADC_SR)); // the others are not its own
    fake_set(ADC1_BASE + ADC_JDR1, 0);
    TEST_ASSERT_EQUAL_INT32(-24816, bridge_take(&bridge).current_mA);
    fake_set(ADC1_BASE + ADC_JDR1, 4095);
    TEST_ASSERT_EQUAL_INT32(40704, bridge_take(&bridge).current_mA);
}

static void test_duties_are_limited_and_whole_at_both_ends(void) {
    static const struct {
        int32_t duty;
        uint32_t counts;
    } cases[] = {{0, 0},         {BRIDGE_FULL / 2, 4200}, {BRIDGE_FULL, 8400},
                 {-1, 0},        {BRIDGE_FULL + 1, 8400}, {INT32_MAX, 8400},
                 {INT32_MIN, 0}, {BRIDGE_FULL - 1, 8399}};
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bridge_duty(&bridge, cases[i].duty);
        TEST_ASSERT_EQUAL_UINT32(cases[i].counts, TIM(TIM1_CCR1));
    }
}

static void test_it_is_switched_on_from_no_duty_and_off_at_once(void) {
    bridge_duty(&bridge, BRIDGE_FULL);
    bridge_enable(&bridge, true);
    TEST_ASSERT_TRUE(bridge_is_on());
    TEST_ASSERT_EQUAL_UINT32(0, TIM(TIM1_CCR1));
    bridge_duty(&bridge, 1000);
    bridge_enable(&bridge, true); // on already: the duty stays
    TEST_ASSERT_TRUE(TIM(TIM1_CCR1) > 0u);
    bridge_enable(&bridge, false);
    TEST_ASSERT_FALSE(bridge_is_on());
    TEST_ASSERT_EQUAL_UINT32(0, TIM(TIM1_CCR1));
}

static void test_a_break_stays_until_it_is_switched_off_and_on_again(void) {
    bridge_enable(&bridge, true);
    bridge_duty(&bridge, BRIDGE_FULL / 2);
    TEST_ASSERT_FALSE(bridge_is_cut(&bridge));
    fake_break_line(true);
    fake_break_line(false);
    fake_set(TIM1_BASE + TIM1_SR, TIM(TIM1_SR) | TIM1_SR_UIF);
    TEST_ASSERT_FALSE(bridge_is_on());
    TEST_ASSERT_TRUE(bridge_is_cut(&bridge));
    bridge_enable(&bridge, true); // of every tick: it was not switched off
    TEST_ASSERT_FALSE(bridge_is_on());
    bridge_enable(&bridge, false);
    TEST_ASSERT_FALSE(bridge_is_cut(&bridge));
    bridge_duty(&bridge, BRIDGE_FULL / 2);
    bridge_enable(&bridge, true);
    TEST_ASSERT_TRUE(bridge_is_on());
    TEST_ASSERT_FALSE(bridge_is_cut(&bridge));
    TEST_ASSERT_EQUAL_HEX32(TIM1_SR_UIF, TIM(TIM1_SR)); // another's flag is left alone
    TEST_ASSERT_EQUAL_UINT32(0, TIM(TIM1_CCR1));
}

static void test_while_the_break_input_is_low_it_does_not_come_on(void) {
    fake_break_line(true);
    TEST_ASSERT_FALSE(bridge_is_cut(&bridge)); // off is no failure
    for (uint32_t i = 0; i < 3u; i++) {
        bridge_enable(&bridge, true);
        TEST_ASSERT_FALSE(bridge_is_on());
        TEST_ASSERT_TRUE(bridge_is_cut(&bridge));
        bridge_enable(&bridge, false);
    }
    fake_break_line(false);
    bridge_enable(&bridge, true);
    TEST_ASSERT_TRUE(bridge_is_on());
}

static void test_without_these_registers_it_stays_off(void) {
    fake_absent();
    bridge_enable(&bridge, true);
    TEST_ASSERT_FALSE(bridge_is_on());
}

static void test_the_dac_opens_at_zero_and_is_limited(void) {
    dac_open();
    TEST_ASSERT_BITS_HIGH(RCC_APB1ENR_DACEN, fake_get(RCC_BASE + RCC_APB1ENR));
    TEST_ASSERT_BITS_HIGH(DAC_CR_EN1, fake_get(DAC_BASE + DAC_CR));
    TEST_ASSERT_BITS_HIGH(DAC_CR_BOFF1, fake_get(DAC_BASE + DAC_CR)); // the buffer ends at 0.2 V
    TEST_ASSERT_EQUAL_UINT32(0, fake_get(DAC_BASE + DAC_DHR12R1));
    TEST_ASSERT_EQUAL_UINT32(3, fake_get(GPIOA_BASE + GPIO_MODER) >> 8 & 3u);
    dac_write(2048);
    TEST_ASSERT_EQUAL_UINT32(2048, fake_get(DAC_BASE + DAC_DHR12R1));
    dac_write(UINT32_MAX);
    TEST_ASSERT_EQUAL_UINT32(DAC_FULL, fake_get(DAC_BASE + DAC_DHR12R1));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_it_opens_switched_off_with_its_break_armed);
    RUN_TEST(test_the_periods_are_20_kHz_and_every_second_one_measures);
    RUN_TEST(test_what_is_measured_has_its_scales);
    RUN_TEST(test_duties_are_limited_and_whole_at_both_ends);
    RUN_TEST(test_it_is_switched_on_from_no_duty_and_off_at_once);
    RUN_TEST(test_a_break_stays_until_it_is_switched_off_and_on_again);
    RUN_TEST(test_while_the_break_input_is_low_it_does_not_come_on);
    RUN_TEST(test_without_these_registers_it_stays_off);
    RUN_TEST(test_the_dac_opens_at_zero_and_is_limited);
    return UNITY_END();
}
