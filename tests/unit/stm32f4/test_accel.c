// Both accelerometers on SPI fakes: a part that answers behind the data register.
#include "fake_registers.h"
#include "spi_stm32f4.h"
#include "stm32f4_gpio.h"
#include "stm32f4_spi.h"
#include "unity.h"

#include <string.h>

#define SR (SPI1_BASE + SPI_SR)
#define DR (SPI1_BASE + SPI_DR)
#define SELECT_BIT (1u << 6) // PB6
#define DRDY_BIT (1u << 7)   // PC7
#define BUS_Hz 84000000u
#define CORE_Hz 3000000u // pauses are short on the host

static hal_accel_t accel;
static uint8_t part[128];
static uint8_t address;
static uint32_t place; ///< bytes of this transfer
static bool is_selected;
static bool is_read;
static bool is_silent; ///< nothing answers, the data never come
static bool is_adxl;
static uint32_t bytes_unselected;
static uint32_t set_while_measuring; ///< settings of the ADXL355, which are for standby

static uint8_t answer(uint8_t out) {
    uint8_t in = 0;
    if (place == 0u) {
        is_read = is_adxl ? (out & 1u) != 0u : (out & 0x80u) != 0u;
        address = is_adxl ? out >> 1 : out & 0x7Fu;
    } else if (is_read) {
        in = part[address++];
    } else if (is_adxl ? address == 0x2Fu : address == 0x12u && (out & 1u) != 0u) {
        part[0x2D] = 1; // reset
    } else {
        const bool is_setting = is_adxl && (address == 0x28u || address == 0x2Cu);
        set_while_measuring += is_setting && (part[0x2D] & 1u) == 0u ? 1u : 0u;
        part[address++] = out;
    }
    place++;
    return in;
}

// RM0090, SPI: a byte that is written comes back as the part's; reading it clears RXNE.
static void transfer(uint32_t at, bool is_write, uint32_t value) {
    if (at == GPIOB_BASE + GPIO_BSRR && is_write) {
        is_selected = (value & SELECT_BIT << 16) != 0u;
        place = 0;
    } else if (at == DR && is_write) {
        bytes_unselected += is_selected ? 0u : 1u;
        fake_set(DR, answer((uint8_t)value));
        fake_set(SR, SPI_SR_TXE | (is_silent ? 0u : SPI_SR_RXNE));
    } else if (at == DR) {
        fake_set(SR, SPI_SR_TXE);
    }
}

static bool open(accel_part_t kind, uint8_t drdy, uint32_t range_g) {
    const accel_wiring_t wiring = {.part = kind,
                                   .spi = SPI1_BASE,
                                   .sck = PIN_A(5),
                                   .miso = PIN_A(6),
                                   .mosi = PIN_A(7),
                                   .select = PIN_B(6),
                                   .drdy = drdy,
                                   .range_g = range_g};
    is_adxl = kind == ACCEL_ADXL355;
    return accel_stm32f4_open(&accel, &wiring, BUS_Hz, CORE_Hz);
}

void setUp(void) {
    fake_reset(FAKE_F405);
    fake_use_hook(transfer);
    memset(part, 0, sizeof part);
    part[0] = 0xAD;
    part[1] = 0x1D;
    part[2] = 0xED;
    part[0x0F] = 0x7B;
    is_selected = is_silent = false;
    bytes_unselected = set_while_measuring = 0;
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
    TEST_ASSERT_EQUAL_UINT32(0, bytes_unselected);
    TEST_ASSERT_EQUAL_UINT32(0, set_while_measuring);
    TEST_ASSERT_FALSE(is_selected);
}

static void test_the_clock_is_one_that_both_parts_take(void) {
    TEST_ASSERT_TRUE(open(ACCEL_ADXL355, PIN_C(7), 2));
    const uint32_t cr1 = fake_get(SPI1_BASE + SPI_CR1);
    const uint32_t divider = 2u << ((cr1 & SPI_CR1_BR) >> SPI_CR1_BR_AT);
    TEST_ASSERT_TRUE(BUS_Hz / divider <= 10000000u && BUS_Hz / divider > 2000000u);
    TEST_ASSERT_BITS_LOW(SPI_CR1_CPOL | SPI_CR1_CPHA | SPI_CR1_LSBFIRST, cr1); // mode 0
    TEST_ASSERT_BITS_HIGH(SPI_CR1_SPE | SPI_CR1_MSTR, cr1);
}

static void test_the_adxl355_is_asked_where_its_line_says_so(void) {
    int32_t counts = 99;
    TEST_ASSERT_TRUE(open(ACCEL_ADXL355, PIN_C(7), 2));
    TEST_ASSERT_EQUAL_HEX8(0x00, part[0x2D]); // measures
    part[0x04] = 1;
    part[0x08] = 0x80; // -524288 on X
    part[0x0B] = 0x00;
    part[0x0D] = 0x50; // 5 on Y
    const uint32_t writes = fake_writes(DR);
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_UINT32(writes, fake_writes(DR)); // no line, no transfer
    fake_set(GPIOC_BASE + GPIO_IDR, DRDY_BIT);
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(-524288, counts);
    fake_set(GPIOC_BASE + GPIO_IDR, 0);
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_Y, &counts));
    TEST_ASSERT_EQUAL_INT32(5, counts);
    TEST_ASSERT_EQUAL_UINT32(writes + 28u, fake_writes(DR)); // 14 bytes a call that has one
}

static void test_the_adxl355_follows_the_rate_of_the_tick(void) {
    static const struct {
        uint32_t rate_Hz;
        uint8_t filter;
    } cases[] = {{4000, 0}, {2000, 1}, {500, 3}, {1000, 2}};
    int32_t counts;
    TEST_ASSERT_TRUE(open(ACCEL_ADXL355, PIN_NONE, 2));
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        TEST_ASSERT_TRUE(accel_stm32f4_set_rate(&accel, cases[i].rate_Hz));
        TEST_ASSERT_EQUAL_HEX8(cases[i].filter, part[0x28]);
        TEST_ASSERT_EQUAL_HEX8(0x00, part[0x2D]);
    }
    const uint32_t writes = fake_writes(DR);
    TEST_ASSERT_TRUE(accel_stm32f4_set_rate(&accel, 1000)); // nothing to do: no sample is lost
    TEST_ASSERT_EQUAL_UINT32(writes, fake_writes(DR));
    part[0x04] = 1;
    TEST_ASSERT_FALSE(accel_stm32f4_set_rate(&accel, 800)); // it has none such, and says nothing
    TEST_ASSERT_EQUAL(PART_NO_RATE, accel.problem.verdict);
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_TRUE(accel_stm32f4_set_rate(&accel, 2000)); // and comes back
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
}

static void test_a_part_that_is_not_there_takes_no_rate(void) {
    part[0] = 0;
    TEST_ASSERT_FALSE(open(ACCEL_ADXL355, PIN_NONE, 2));
    const uint32_t writes = fake_writes(DR);
    TEST_ASSERT_FALSE(accel_stm32f4_set_rate(&accel, 1000));
    TEST_ASSERT_EQUAL_UINT32(writes, fake_writes(DR));
    TEST_ASSERT_TRUE(open(ACCEL_IIS3DWB, PIN_NONE, 2));
    TEST_ASSERT_TRUE(accel_stm32f4_set_rate(&accel, 2500)); // any: one rate for all
}

static void test_the_iis3dwb_is_read_in_its_byte_order(void) {
    int32_t counts = 99;
    TEST_ASSERT_TRUE(open(ACCEL_IIS3DWB, PIN_NONE, 4));
    TEST_ASSERT_EQUAL_HEX8(0xAA, part[0x10]); // on, low-pass, 4 g
    TEST_ASSERT_EQUAL_HEX8(0x80, part[0x17]);
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    part[0x1E] = 1;
    part[0x28] = 0x34;
    part[0x29] = 0x12;
    part[0x2C] = 0xFF;
    part[0x2D] = 0xFF;
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(0x1234, counts);
    part[0x1E] = 0;
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_Z, &counts));
    TEST_ASSERT_EQUAL_INT32(-1, counts);
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_Z, &counts));
}

static void test_a_part_that_is_not_there_gives_no_sample(void) {
    int32_t counts = 99;
    part[0] = part[0x0F] = 0;
    TEST_ASSERT_FALSE(open(ACCEL_ADXL355, PIN_NONE, 2));
    TEST_ASSERT_EQUAL(PART_NOT_THERE, accel.problem.verdict);
    TEST_ASSERT_FALSE(open(ACCEL_IIS3DWB, PIN_NONE, 2));
    TEST_ASSERT_EQUAL(PART_NOT_THERE, accel.problem.verdict);
    TEST_ASSERT_FALSE(open(ACCEL_IIS3DWB, PIN_NONE, 3));
    TEST_ASSERT_EQUAL(PART_NO_RANGE, accel.problem.verdict);
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_FALSE(open(ACCEL_NONE, PIN_NONE, 2));
}

static void test_an_spi_that_is_silent_does_not_hang(void) {
    int32_t counts = 99;
    TEST_ASSERT_TRUE(open(ACCEL_IIS3DWB, PIN_NONE, 2));
    is_silent = true;
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_UINT32(1, accel.iis3dwb.failures);
    TEST_ASSERT_FALSE(open(ACCEL_ADXL355, PIN_NONE, 2));
    TEST_ASSERT_EQUAL(PART_NO_TRANSFER, accel.problem.verdict);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_clock_is_one_that_both_parts_take);
    RUN_TEST(test_the_adxl355_is_asked_where_its_line_says_so);
    RUN_TEST(test_the_adxl355_follows_the_rate_of_the_tick);
    RUN_TEST(test_a_part_that_is_not_there_takes_no_rate);
    RUN_TEST(test_the_iis3dwb_is_read_in_its_byte_order);
    RUN_TEST(test_a_part_that_is_not_there_gives_no_sample);
    RUN_TEST(test_an_spi_that_is_silent_does_not_hang);
    return UNITY_END();
}
