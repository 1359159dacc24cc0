// Pins, the tick and the console on fakes.
#include "fake_registers.h"
#include "pins.h"
#include "stm32f4_gpio.h"
#include "stm32f4_rcc.h"
#include "stm32f4_tim5.h"
#include "stm32f4_usart.h"
#include "tick_stm32f4.h"
#include "uart_stm32f4.h"
#include "unity.h"

#define ODR_B (GPIOB_BASE + GPIO_ODR)
#define MODER_B (GPIOB_BASE + GPIO_MODER)
#define USART_STATUS (USART1_BASE + USART_SR)
#define USART_DATA (USART1_BASE + USART_DR)

static hal_uart_t uart;
static bool glitched;     ///< a pin was an output before its level was there
static uint32_t arriving; ///< bytes that come while the status is read

// RM0090, GPIOx_BSRR: sets and resets bits of ODR, setting wins.
static void drive(uint32_t address, bool is_write, uint32_t value) {
    if (address == GPIOB_BASE + GPIO_BSRR && is_write) {
        fake_set(ODR_B, (fake_get(ODR_B) & ~(value >> 16)) | (value & 0xFFFFu));
    }
    if (address == MODER_B && is_write && (value >> 8 & 3u) == 1u) {
        glitched = glitched || (fake_get(ODR_B) & 1u << 4) == 0u;
    }
}

// RM0090 Rev 11, page 968: reading the status, then the data, clears RXNE and the errors.
static void read_data(uint32_t address, bool is_write, uint32_t value) {
    static bool status_was_read;
    (void)value;
    if (address == USART_STATUS && !is_write) {
        status_was_read = true;
    } else if (address == USART_DATA && !is_write && status_was_read) {
        status_was_read = false;
        arriving--;
        fake_set(USART_STATUS, USART_SR_TXE | (arriving > 0u ? USART_SR_RXNE : 0u));
    }
}

void setUp(void) {
    fake_reset(FAKE_F405);
    glitched = false;
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
}

static void test_an_output_has_its_level_before_it_drives(void) {
    fake_use_hook(drive);
    pin_output(PIN_B(4), true);
    TEST_ASSERT_FALSE(glitched);
    TEST_ASSERT_EQUAL_UINT32(1u, fake_get(MODER_B) >> 8 & 3u);
    TEST_ASSERT_BITS_HIGH(1u << 4, fake_get(ODR_B));
    TEST_ASSERT_BITS_HIGH(RCC_AHB1ENR_GPIOBEN, fake_get(RCC_BASE + RCC_AHB1ENR));
    pin_write(PIN_B(4), false);
    TEST_ASSERT_EQUAL_HEX32(0, fake_get(ODR_B));
}

// The debugger's pins are PA13, PA14, PB3, PB4: what a pin is set to leaves its neighbours alone.
static void test_a_function_leaves_the_other_pins_alone(void) {
    const uint32_t before = fake_get(GPIOA_BASE + GPIO_MODER);
    pin_function(PIN_A(9), 7, PIN_UP);
    TEST_ASSERT_EQUAL_HEX32(before | 2u << 18, fake_get(GPIOA_BASE + GPIO_MODER));
    TEST_ASSERT_EQUAL_HEX32(7u << 4, fake_get(GPIOA_BASE + GPIO_AFRH));
    TEST_ASSERT_EQUAL_HEX32(0, fake_get(GPIOA_BASE + GPIO_AFRL));
    pin_function(PIN_A(3), 7, PIN_FLOATS);
    TEST_ASSERT_EQUAL_HEX32(7u << 12, fake_get(GPIOA_BASE + GPIO_AFRL));
    pin_analog(PIN_C(0));
    TEST_ASSERT_EQUAL_UINT32(3u, fake_get(GPIOC_BASE + GPIO_MODER) & 3u);
}

static void test_inputs_are_read_and_one_that_is_not_wired_is_low(void) {
    pin_input(PIN_C(13), PIN_UP);
    TEST_ASSERT_EQUAL_UINT32(1u, fake_get(GPIOC_BASE + GPIO_PUPDR) >> 26);
    TEST_ASSERT_FALSE(pin_read(PIN_C(13)));
    fake_set(GPIOC_BASE + GPIO_IDR, 1u << 13);
    TEST_ASSERT_TRUE(pin_read(PIN_C(13)));
    const uint32_t writes = fake_all_writes();
    pin_output(PIN_NONE, true);
    pin_write(PIN_NONE, true);
    pin_function(PIN_NONE, 1, PIN_UP);
    TEST_ASSERT_FALSE(pin_read(PIN_NONE));
    TEST_ASSERT_EQUAL_UINT32(writes, fake_all_writes());
}

static void test_ticks_are_whole_periods_also_over_the_counts_wrap(void) {
    hal_tick_t tick = {.clock_Hz = 84000000u};
    fake_set(TIM5_BASE + TIM5_CNT, UINT32_MAX - 1000u);
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 1000));
    TEST_ASSERT_EQUAL_UINT32(0, hal_tick_elapsed(&tick));
    fake_set(TIM5_BASE + TIM5_CNT, 83999u - 1001u);
    TEST_ASSERT_EQUAL_UINT32(0, hal_tick_elapsed(&tick));
    fake_set(TIM5_BASE + TIM5_CNT, 84000u - 1001u);
    TEST_ASSERT_EQUAL_UINT32(1, hal_tick_elapsed(&tick));
    fake_set(TIM5_BASE + TIM5_CNT, 84000u * 2000u);
    TEST_ASSERT_EQUAL_UINT32(1999, hal_tick_elapsed(&tick)); // two seconds of erasing flash
    TEST_ASSERT_BITS_HIGH(TIM5_CR1_CEN, fake_get(TIM5_BASE + TIM5_CR1));
}

static void test_what_is_left_of_a_tick_is_told_in_cycles_of_the_core(void) {
    hal_tick_t tick = {.clock_Hz = 84000000u};
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 1000));
    TEST_ASSERT_EQUAL_UINT32(168000, tick_stm32f4_left(&tick, 168000000u));
    fake_set(TIM5_BASE + TIM5_CNT, 83999u);
    TEST_ASSERT_EQUAL_UINT32(2, tick_stm32f4_left(&tick, 168000000u));
    fake_set(TIM5_BASE + TIM5_CNT, 84000u);
    TEST_ASSERT_EQUAL_UINT32(0, tick_stm32f4_left(&tick, 168000000u));
    fake_set(TIM5_BASE + TIM5_CNT, 90000u);
    TEST_ASSERT_EQUAL_UINT32(0, tick_stm32f4_left(&tick, 168000000u));
}

static void test_rates_that_cannot_be_made_are_refused(void) {
    hal_tick_t tick = {.clock_Hz = 84000000u};
    TEST_ASSERT_FALSE(hal_tick_start(&tick, 0));
    TEST_ASSERT_FALSE(hal_tick_start(&tick, 100001));
    TEST_ASSERT_FALSE(hal_tick_start(&tick, 1100));
    TEST_ASSERT_EQUAL_UINT32(0, fake_all_writes());
}

static void test_the_divider_is_rounded_to_a_sixteenth(void) {
    static const struct {
        uint32_t clock_Hz, baud, brr;
    } cases[] = {{84000000, 1000000, 84},
                 {42000000, 1000000, 42},
                 {42000000, 115200, 365},
                 {16000000, 1000000, 16}};
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uart_stm32f4_open(&uart, USART1_BASE, cases[i].clock_Hz, cases[i].baud);
        TEST_ASSERT_EQUAL_UINT32(cases[i].brr, fake_get(USART1_BASE + USART_BRR));
    }
    TEST_ASSERT_BITS_HIGH(RCC_APB2ENR_USART1EN, fake_get(RCC_BASE + RCC_APB2ENR));
    uart_stm32f4_open(&uart, USART3_BASE, 42000000, 1000000);
    TEST_ASSERT_BITS_HIGH(RCC_APB1ENR_USART3EN, fake_get(RCC_BASE + RCC_APB1ENR));
}

static void arrive(uint8_t byte, uint32_t flags) {
    arriving = 1;
    fake_set(USART_DATA, byte);
    fake_set(USART_STATUS, USART_SR_TXE | USART_SR_RXNE | flags);
    uart_stm32f4_interrupt(&uart);
}

static void test_bytes_go_through_the_ring_in_their_order(void) {
    uint8_t byte = 0;
    uart_stm32f4_open(&uart, USART1_BASE, 84000000, 1000000);
    fake_use_hook(read_data);
    for (uint32_t i = 0; i < 3u * UART_RING_BYTES; i++) {
        arrive((uint8_t)(i * 7u), 0);
        arrive((uint8_t)(i * 7u + 1u), 0);
        TEST_ASSERT_TRUE(hal_uart_read(&uart, &byte));
        TEST_ASSERT_EQUAL_HEX8(i * 7u, byte);
        TEST_ASSERT_TRUE(hal_uart_read(&uart, &byte));
        TEST_ASSERT_EQUAL_HEX8(i * 7u + 1u, byte);
    }
    TEST_ASSERT_FALSE(hal_uart_read(&uart, &byte));
    TEST_ASSERT_EQUAL_UINT32(0, uart.overruns);
}

static void test_what_is_lost_is_counted(void) {
    uint8_t byte = 0;
    uart_stm32f4_open(&uart, USART1_BASE, 84000000, 1000000);
    fake_use_hook(read_data);
    arrive('a', USART_SR_ORE); // the hardware lost one behind this
    TEST_ASSERT_EQUAL_UINT32(1, uart.overruns);
    TEST_ASSERT_TRUE(hal_uart_read(&uart, &byte));
    TEST_ASSERT_EQUAL_HEX8('a', byte);
    fake_set(USART_STATUS, USART_SR_ORE); // without data
    arriving = 1;
    uart_stm32f4_interrupt(&uart);
    TEST_ASSERT_FALSE(hal_uart_read(&uart, &byte));
    TEST_ASSERT_EQUAL_UINT32(2, uart.overruns);
    for (uint32_t i = 0; i < UART_RING_BYTES + 3u; i++) {
        arrive((uint8_t)i, 0);
    }
    TEST_ASSERT_EQUAL_UINT32(5, uart.overruns); // the ring was full
    TEST_ASSERT_TRUE(hal_uart_read(&uart, &byte));
    TEST_ASSERT_EQUAL_HEX8(0, byte);
    uart.overruns = UINT32_MAX;
    arrive('b', USART_SR_ORE);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, uart.overruns);
}

static void test_a_transmitter_that_is_stuck_does_not_hang(void) {
    uart_stm32f4_open(&uart, USART1_BASE, 84000000, 1000000);
    fake_set(USART_STATUS, 0);
    TEST_ASSERT_FALSE(uart_stm32f4_is_free(&uart));
    const uint32_t writes = fake_writes(USART_DATA);
    hal_uart_write(&uart, 'x');
    TEST_ASSERT_EQUAL_UINT32(writes, fake_writes(USART_DATA));
    fake_set(USART_STATUS, USART_SR_TXE);
    hal_uart_write(&uart, 'x');
    TEST_ASSERT_EQUAL_UINT32('x', fake_get(USART_DATA));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_an_output_has_its_level_before_it_drives);
    RUN_TEST(test_a_function_leaves_the_other_pins_alone);
    RUN_TEST(test_inputs_are_read_and_one_that_is_not_wired_is_low);
    RUN_TEST(test_ticks_are_whole_periods_also_over_the_counts_wrap);
    RUN_TEST(test_what_is_left_of_a_tick_is_told_in_cycles_of_the_core);
    RUN_TEST(test_rates_that_cannot_be_made_are_refused);
    RUN_TEST(test_the_divider_is_rounded_to_a_sixteenth);
    RUN_TEST(test_bytes_go_through_the_ring_in_their_order);
    RUN_TEST(test_what_is_lost_is_counted);
    RUN_TEST(test_a_transmitter_that_is_stuck_does_not_hang);
    return UNITY_END();
}
