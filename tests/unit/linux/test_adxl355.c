// Against a model of the part's registers, after its data sheet: the transfers are the driver's
// own, the SPI bus and the part are not there. Untested on hardware.
#include "accel_backends.h"
#include "adxl355.h"
#include "adxl355_error.h"
#include "one_line.h"
#include "unity.h"

#define REGISTERS 0x60u

static struct {
    uint8_t registers[REGISTERS];
    bool is_dead;        ///< transfers fail
    bool is_stuck;       ///< writes are lost
    uint32_t bad_resets; ///< that load other shadow registers
    uint32_t resets;
    uint32_t transfers;
    uint32_t paused_ms;
} part;

static adxl355_t chip;
static linux_error_t error;

static void reset_part(void) {
    static const uint8_t ids[4] = {0xAD, 0x1D, 0xED, 0x01};
    static const uint8_t shadows[5] = {1, 2, 3, 4, 5};
    memset(part.registers, 0, sizeof part.registers);
    memcpy(part.registers, ids, sizeof ids);
    memcpy(&part.registers[0x50], shadows, sizeof shadows);
    part.registers[0x2C] = 0x81;
    part.registers[0x2D] = 0x01;
    if (part.resets > 0u && part.resets <= part.bad_resets) {
        part.registers[0x52] = 0xEE;
    }
}

static bool exchange(void *context, const uint8_t *out, uint8_t *in, size_t bytes) {
    TEST_ASSERT_EQUAL_PTR(&part, context);
    TEST_ASSERT_TRUE(bytes >= 2u && bytes <= ADXL355_MAX_TRANSFER);
    part.transfers++;
    if (part.is_dead) {
        return false;
    }
    const size_t address = out[0] >> 1;
    const bool is_read = (out[0] & 1u) != 0u;
    for (size_t i = 1; i < bytes; i++) {
        TEST_ASSERT_TRUE(address + i - 1u < REGISTERS);
        if (is_read) {
            in[i] = part.registers[address + i - 1u];
        } else if (address == 0x2F && out[i] == 0x52) {
            part.resets++;
            reset_part();
        } else if (!part.is_stuck) {
            part.registers[address + i - 1u] = out[i];
        }
    }
    if (is_read && address + bytes - 2u >= 0x10u && address <= 0x10u) {
        part.registers[4] &= 0xFEu; // reading the data makes them old
    }
    return true;
}

static void pause_ms(void *context, uint32_t ms) {
    TEST_ASSERT_EQUAL_PTR(&part, context);
    part.paused_ms += ms;
}

static bool start(uint32_t range_g, uint32_t rate_Hz) {
    part_problem_t problem = {0};
    const bool is_well =
        adxl355_start(&chip, (part_bus_t){exchange, pause_ms, &part}, range_g, rate_Hz, &problem);
    TEST_ASSERT_EQUAL(is_well, adxl355_explain(&problem, range_g, rate_Hz, &error));
    return is_well;
}

void setUp(void) {
    error.text[0] = '\0';
    memset(&part, 0, sizeof part);
    reset_part();
}

void tearDown(void) {}

static void put_sample(size_t axis, int32_t counts) {
    const uint32_t word = (uint32_t)counts << 4;
    uint8_t *const at = &part.registers[0x08u + 3u * axis];
    at[0] = (uint8_t)(word >> 16);
    at[1] = (uint8_t)(word >> 8);
    at[2] = (uint8_t)word;
}

static void test_part_is_reset_set_and_started(void) {
    static const struct {
        uint32_t range_g;
        uint32_t rate_Hz;
        uint8_t range;
        uint8_t filter;
    } cases[] = {{2, 4000, 0x81, 0}, {4, 2000, 0x82, 1}, {8, 1000, 0x83, 2}, {2, 500, 0x81, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        part.registers[0x2B] = 0x02;
        TEST_ASSERT_TRUE_MESSAGE(start(cases[i].range_g, cases[i].rate_Hz), error.text);
        TEST_ASSERT_EQUAL_UINT32(i + 1u, part.resets);
        TEST_ASSERT_EQUAL_UINT32(10u * part.resets, part.paused_ms);
        TEST_ASSERT_EQUAL_HEX8(0, part.registers[0x2B]);
        TEST_ASSERT_EQUAL_HEX8(cases[i].range, part.registers[0x2C]);
        TEST_ASSERT_EQUAL_HEX8(cases[i].filter, part.registers[0x28]);
        TEST_ASSERT_EQUAL_HEX8(0, part.registers[0x2D]);
    }
    TEST_ASSERT_TRUE(adxl355_stop(&chip));
    TEST_ASSERT_EQUAL_HEX8(1, part.registers[0x2D]);
}

static void test_samples_are_signed_20_bits_and_fresh_once(void) {
    static const int32_t values[] = {0, 1, -1, 524287, -524288, 256000, -256000};
    int32_t counts = 99;
    TEST_ASSERT_TRUE(start(2, 1000));
    TEST_ASSERT_FALSE(adxl355_read(&chip, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(99, counts);
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        put_sample(0, values[i]);
        put_sample(1, -values[i] / 2);
        put_sample(2, 3);
        part.registers[0x04] = 0x01;
        const uint32_t before = part.transfers;
        TEST_ASSERT_TRUE(adxl355_read(&chip, HAL_AXIS_X, &counts));
        TEST_ASSERT_EQUAL_UINT32(before + 1u, part.transfers);
        TEST_ASSERT_EQUAL_INT32(values[i], counts);
        TEST_ASSERT_FALSE(adxl355_read(&chip, HAL_AXIS_X, &counts));
        TEST_ASSERT_TRUE(adxl355_read(&chip, HAL_AXIS_Y, &counts));
        TEST_ASSERT_EQUAL_INT32(-values[i] / 2, counts);
        TEST_ASSERT_TRUE(adxl355_read(&chip, HAL_AXIS_Z, &counts));
        TEST_ASSERT_EQUAL_INT32(3, counts);
    }
    TEST_ASSERT_EQUAL_UINT32(0, chip.failures);
}

static void test_low_bits_of_the_last_byte_are_no_data(void) {
    int32_t counts = 0;
    TEST_ASSERT_TRUE(start(2, 1000));
    put_sample(0, 5);
    part.registers[0x0A] |= 0x0F;
    part.registers[0x04] = 0xFF;
    TEST_ASSERT_TRUE(adxl355_read(&chip, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(5, counts);
}

static void test_lost_part_is_counted_and_no_sample(void) {
    int32_t counts = 99;
    TEST_ASSERT_TRUE(start(2, 1000));
    part.registers[0x04] = 0x01;
    part.is_dead = true;
    TEST_ASSERT_FALSE(adxl355_read(&chip, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(99, counts);
    TEST_ASSERT_EQUAL_UINT32(1, chip.failures);
    TEST_ASSERT_FALSE(adxl355_stop(&chip));
    chip.failures = UINT32_MAX;
    TEST_ASSERT_FALSE(adxl355_read(&chip, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, chip.failures);
    part.is_dead = false;
    TEST_ASSERT_TRUE(adxl355_read(&chip, HAL_AXIS_X, &counts));
}

static void test_other_part_or_none_is_refused(void) {
    for (size_t i = 0; i < 3u; i++) {
        reset_part();
        part.registers[i] ^= 1u;
        TEST_ASSERT_FALSE(start(2, 1000));
        assert_one_line(&error, "instead of ad 1d ed");
    }
    TEST_ASSERT_EQUAL_UINT32(0, part.resets);
    part.is_dead = true;
    TEST_ASSERT_FALSE(start(2, 1000));
    assert_one_line(&error, "transfer failed");
}

static void test_reset_is_repeated_where_it_went_wrong(void) {
    part.bad_resets = 2;
    TEST_ASSERT_TRUE(start(2, 1000));
    TEST_ASSERT_EQUAL_UINT32(3, part.resets);
    part.resets = 0;
    part.bad_resets = 100;
    TEST_ASSERT_FALSE(start(2, 1000));
    assert_one_line(&error, "does not reset");
    TEST_ASSERT_EQUAL_UINT32(3, part.resets);
}

static void test_setting_that_is_not_stored_is_refused(void) {
    part.is_stuck = true;
    TEST_ASSERT_FALSE(start(8, 1000));
    assert_one_line(&error, "register 0x2c reads 0x81 after 0x83");
}

static void test_wrong_options_are_one_line(void) {
    hal_accel_t accel;
    static const uint32_t ranges[] = {0, 1, 3, 16};
    static const uint32_t rates[] = {0, 250, 1001, 8000};
    for (size_t i = 0; i < 4u; i++) {
        TEST_ASSERT_FALSE(start(ranges[i], 1000));
        assert_one_line(&error, "one of 2, 4, 8");
        TEST_ASSERT_FALSE(start(2, rates[i]));
        assert_one_line(&error, "one of 4000, 2000, 1000, 500");
    }
    TEST_ASSERT_EQUAL_UINT32(0, part.transfers);
    accel_adxl355_options_t options = {.device = "/dev/null", .range_g = 2, .rate_Hz = 1000};
    TEST_ASSERT_NULL(accel_adxl355_open(&options, &accel, &error));
    assert_one_line(&error, "clock 0 Hz");
    options.clock_Hz = 10000001;
    TEST_ASSERT_NULL(accel_adxl355_open(&options, &accel, &error));
    assert_one_line(&error, "clock 10000001 Hz");
    options.clock_Hz = 5000000;
    TEST_ASSERT_NULL(accel_adxl355_open(&options, &accel, &error));
    assert_one_line(&error, "/dev/null: not an SPI device");
    options.device = "/dev/no-such-spidev";
    TEST_ASSERT_NULL(accel_adxl355_open(&options, &accel, &error));
    assert_one_line(&error, "No such file");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_part_is_reset_set_and_started);
    RUN_TEST(test_samples_are_signed_20_bits_and_fresh_once);
    RUN_TEST(test_low_bits_of_the_last_byte_are_no_data);
    RUN_TEST(test_lost_part_is_counted_and_no_sample);
    RUN_TEST(test_other_part_or_none_is_refused);
    RUN_TEST(test_reset_is_repeated_where_it_went_wrong);
    RUN_TEST(test_setting_that_is_not_stored_is_refused);
    RUN_TEST(test_wrong_options_are_one_line);
    return UNITY_END();
}
