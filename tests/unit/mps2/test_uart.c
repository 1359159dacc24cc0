// The driver on registers in memory.
#include "uart_mps2.h"
#include "unity.h"

static cmsdk_uart_t registers;
static hal_uart_t uart;

void setUp(void) {
    registers = (cmsdk_uart_t){0};
    uart_mps2_open(&uart, &registers, 1000000);
}

void tearDown(void) {}

static void test_a_byte_is_read_once_it_is_there(void) {
    uint8_t byte = 0x11;
    TEST_ASSERT_FALSE(hal_uart_read(&uart, &byte));
    TEST_ASSERT_EQUAL_HEX8(0x11, byte);
    registers.state = CMSDK_UART_STATE_RX_FULL;
    registers.data = 0x5A;
    TEST_ASSERT_TRUE(hal_uart_read(&uart, &byte));
    TEST_ASSERT_EQUAL_HEX8(0x5A, byte);
    TEST_ASSERT_EQUAL_UINT32(0, uart.overruns);
}

// The hardware clears the bit that is written; memory shows what was.
static void test_an_overrun_is_counted_and_cleared(void) {
    uint8_t byte;
    registers.state = CMSDK_UART_STATE_RX_OVERRUN;
    (void)hal_uart_read(&uart, &byte);
    TEST_ASSERT_EQUAL_UINT32(1, uart.overruns);
    registers.state = CMSDK_UART_STATE_RX_OVERRUN | CMSDK_UART_STATE_RX_FULL;
    (void)hal_uart_read(&uart, &byte);
    TEST_ASSERT_EQUAL_HEX32(CMSDK_UART_STATE_RX_OVERRUN, registers.state);
    TEST_ASSERT_EQUAL_UINT32(2, uart.overruns);
    uart.overruns = UINT32_MAX;
    (void)hal_uart_read(&uart, &byte);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, uart.overruns);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_byte_is_read_once_it_is_there);
    RUN_TEST(test_an_overrun_is_counted_and_cleared);
    return UNITY_END();
}
