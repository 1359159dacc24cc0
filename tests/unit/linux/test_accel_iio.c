// Against the kernel's file interface in a folder: sysfs attributes are files, the buffer's
// character device is a FIFO. Untested on hardware.
#include "accel_backends.h"
#include "iio_scan.h"
#include "one_line.h"
#include "scratch.h"
#include "unity.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#define DEVICE "sys/iio:device1"
#define ELEMENTS DEVICE "/scan_elements/"

static char sysfs_root[SCRATCH_BYTES];
static char dev_root[SCRATCH_BYTES];
static hal_accel_t accel;
static accel_iio_t *device;
static linux_error_t error;
static int fifo;

static void make_device(const char *folder, const char *name) {
    char path[SCRATCH_BYTES];
    scratch_folder(folder);
    (void)snprintf(path, sizeof path, "%s/name", folder);
    scratch_write(path, name);
}

static void make_axis(char axis, const char *raw) {
    char path[SCRATCH_BYTES];
    (void)snprintf(path, sizeof path, DEVICE "/in_accel_%c_raw", axis);
    scratch_write(path, raw);
}

static void make_element(const char *channel, const char *index, const char *type) {
    char path[SCRATCH_BYTES];
    scratch_folder(DEVICE "/scan_elements");
    (void)snprintf(path, sizeof path, ELEMENTS "%s_en", channel);
    scratch_write(path, "0\n");
    (void)snprintf(path, sizeof path, ELEMENTS "%s_index", channel);
    scratch_write(path, index);
    (void)snprintf(path, sizeof path, ELEMENTS "%s_type", channel);
    scratch_write(path, type);
}

/// As the kernel's driver for the ADXL355 shows itself: x, y, z of 20 bits and a time stamp.
static void make_buffered_device(void) {
    make_element("in_accel_x", "0\n", "be:s20/32>>12\n");
    make_element("in_accel_y", "1\n", "be:s20/32>>12\n");
    make_element("in_accel_z", "2\n", "be:s20/32>>12\n");
    make_element("in_timestamp", "3\n", "le:s64/64>>0\n");
    scratch_write(ELEMENTS "in_timestamp_en", "1\n");
    scratch_folder(DEVICE "/buffer");
    scratch_write(DEVICE "/buffer/enable", "0\n");
    scratch_write(DEVICE "/buffer/length", "2\n");
    scratch_folder(DEVICE "/trigger");
    scratch_write(DEVICE "/trigger/current_trigger", "\n");
    TEST_ASSERT_EQUAL_INT(0, mkfifo(scratch_path("dev/iio:device1"), 0600));
    fifo = open(scratch_path("dev/iio:device1"), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    TEST_ASSERT_TRUE(fifo >= 0);
}

void setUp(void) {
    error.text[0] = '\0';
    device = NULL;
    fifo = -1;
    scratch_make();
    scratch_folder("dev");
    make_device("sys/iio:device0", "adc\n");
    make_device(DEVICE, "adxl355\n");
    (void)snprintf(sysfs_root, sizeof sysfs_root, "%s", scratch_path("sys"));
    (void)snprintf(dev_root, sizeof dev_root, "%s", scratch_path("dev"));
}

void tearDown(void) {
    accel_iio_close(device);
    if (fifo >= 0) {
        (void)close(fifo);
    }
    scratch_remove();
}

static accel_iio_options_t options_of(const char *name, bool use_buffer) {
    return (accel_iio_options_t){
        .device = name, .use_buffer = use_buffer, .sysfs_root = sysfs_root, .dev_root = dev_root};
}

static void open_device(const char *name, bool use_buffer) {
    const accel_iio_options_t options = options_of(name, use_buffer);
    device = accel_iio_open(&options, &accel, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(device, error.text);
}

static void assert_refused(const char *name, bool use_buffer, const char *part) {
    const accel_iio_options_t options = options_of(name, use_buffer);
    TEST_ASSERT_NULL(accel_iio_open(&options, &accel, &error));
    assert_one_line(&error, part);
}

static void test_single_reads_are_of_the_file_as_it_is_now(void) {
    int32_t counts = 0;
    make_axis('x', "-12345\n");
    make_axis('y', "7\n");
    open_device("adxl355", false);
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(-12345, counts);
    make_axis('x', "524287\n");
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(524287, counts);
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_Y, &counts));
    TEST_ASSERT_EQUAL_INT32(7, counts);
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_Z, &counts));
    TEST_ASSERT_EQUAL_UINT32(0, accel_iio_failures(device));
}

static void test_sensor_of_one_axis_answers_on_all(void) {
    int32_t counts = 0;
    make_axis('y', "-1\n");
    open_device("iio:device1", false);
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_Z, &counts));
    TEST_ASSERT_EQUAL_INT32(-1, counts);
}

static void test_contents_that_are_no_number_are_counted_and_no_sample(void) {
    static const char *const contents[] = {
        "",
        "\n",
        "text\n",
        "12x\n",
        "0x10\n",
        "1.5\n",
        "--1\n",
        "2147483648\n",
        "-2147483649\n",
        "1 2\n",
        "99999999999999999999999999999999999999999999999999999999999999999999\n",
    };
    const uint32_t count = sizeof contents / sizeof contents[0];
    int32_t counts = 77;
    make_axis('x', "1\n");
    open_device("adxl355", false);
    for (uint32_t i = 0; i < count; i++) {
        make_axis('x', contents[i]);
        TEST_ASSERT_FALSE_MESSAGE(hal_accel_read(&accel, HAL_AXIS_X, &counts), contents[i]);
        TEST_ASSERT_EQUAL_INT32(77, counts);
        TEST_ASSERT_EQUAL_UINT32(i + 1u, accel_iio_failures(device));
    }
    make_axis('x', "2147483647\n");
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, counts);
}

static void test_device_that_is_not_there_is_one_line(void) {
    assert_refused("iio:device7", false, "IIO device 'iio:device7': there is none");
    assert_refused("mpu6050", false, "there is none of this name");
    assert_refused("", false, "give iio:device0");
    assert_refused(NULL, false, "give iio:device0");
    assert_refused("../../etc", false, "give iio:device0");
    assert_refused("adc", false, "this is no accelerometer");
    make_device("sys/iio:device2", "adxl355\n");
    assert_refused("adxl355", false, "2 devices");
    make_device("sys/iio:device3", "");
    assert_refused("none", false, "there is none of this name");
    (void)snprintf(sysfs_root, sizeof sysfs_root, "%s", scratch_path("no-folder"));
    assert_refused("adxl355", false, "No such file");
    memset(sysfs_root, 'a', sizeof sysfs_root - 1u);
    sysfs_root[sizeof sysfs_root - 1u] = '\0';
    assert_refused("iio:device0", false, "too long");
}

/// One scan of the buffered device.
static void put_scan(int32_t x, int32_t y, int32_t z) {
    const int32_t values[3] = {x, y, z};
    uint8_t scan[12];
    for (size_t i = 0; i < 3; i++) {
        const uint32_t word = (uint32_t)values[i] << 12;
        for (size_t k = 0; k < 4; k++) {
            scan[4 * i + k] = (uint8_t)(word >> (24u - 8u * k));
        }
    }
    TEST_ASSERT_EQUAL_INT(sizeof scan, write(fifo, scan, sizeof scan));
}

static void test_channel_is_read_by_itself_whatever_it_measures(void) {
    const sensor_iio_options_t options = {"adxl355", "voltage0", sysfs_root};
    int32_t counts = 77;
    scratch_write(DEVICE "/in_voltage0_raw", "-4321\n");
    sensor_iio_t *const sensor = sensor_iio_open(&options, &accel, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(sensor, error.text);
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_Z, &counts));
    TEST_ASSERT_EQUAL_INT32(-4321, counts);
    scratch_write(DEVICE "/in_voltage0_raw", "2147483648\n");
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(-4321, counts);
    TEST_ASSERT_EQUAL_UINT32(1, sensor_iio_failures(sensor));
    sensor_iio_close(sensor);
}

static void test_channel_that_is_not_there_is_one_line(void) {
    const sensor_iio_options_t no_channel = {"adxl355", "voltage9", sysfs_root};
    const sensor_iio_options_t no_device = {"thermometer", "voltage0", sysfs_root};
    TEST_ASSERT_NULL(sensor_iio_open(&no_channel, &accel, &error));
    assert_one_line(&error, "in_voltage9_raw");
    TEST_ASSERT_NULL(sensor_iio_open(&no_device, &accel, &error));
    assert_one_line(&error, "thermometer");
}

static void test_buffer_is_set_up_and_gives_the_newest_scan(void) {
    int32_t counts = 0;
    make_buffered_device();
    open_device("adxl355", true);
    TEST_ASSERT_EQUAL_STRING("1", scratch_read(ELEMENTS "in_accel_x_en"));
    TEST_ASSERT_EQUAL_STRING("1", scratch_read(ELEMENTS "in_accel_z_en"));
    TEST_ASSERT_EQUAL_STRING("0", scratch_read(ELEMENTS "in_timestamp_en"));
    TEST_ASSERT_EQUAL_STRING("1", scratch_read(DEVICE "/buffer/enable"));
    TEST_ASSERT_EQUAL_STRING("128", scratch_read(DEVICE "/buffer/length"));
    TEST_ASSERT_EQUAL_STRING("", scratch_read(DEVICE "/trigger/current_trigger"));
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    put_scan(1, 2, 3);
    put_scan(-524288, 524287, -1);
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(-524288, counts);
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_X, &counts)); // nothing since
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_Y, &counts));
    TEST_ASSERT_EQUAL_INT32(524287, counts);
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_Z, &counts));
    TEST_ASSERT_EQUAL_INT32(-1, counts);
    for (int32_t i = 0; i < 100; i++) { // more than one read takes
        put_scan(i, 0, 0);
    }
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(99, counts);
    TEST_ASSERT_EQUAL_UINT32(0, accel_iio_failures(device));
    accel_iio_close(device);
    device = NULL;
    TEST_ASSERT_EQUAL_STRING("0", scratch_read(DEVICE "/buffer/enable"));
}

static void test_one_read_of_a_flood_is_bounded(void) {
    int32_t counts = 0;
    make_buffered_device();
    open_device("adxl355", true);
    for (int32_t i = 0; i < 300; i++) {
        put_scan(i, 0, 0);
    }
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(255, counts);
    TEST_ASSERT_TRUE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_INT32(299, counts);
}

static void test_part_of_a_scan_and_a_lost_device_are_counted(void) {
    int32_t counts = 5;
    make_buffered_device();
    open_device("adxl355", true);
    TEST_ASSERT_EQUAL_INT(5, write(fifo, "\1\2\3\4\5", 5));
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_UINT32(1, accel_iio_failures(device));
    (void)close(fifo); // its other end: reads give nothing at all
    fifo = -1;
    TEST_ASSERT_FALSE(hal_accel_read(&accel, HAL_AXIS_X, &counts));
    TEST_ASSERT_EQUAL_UINT32(2, accel_iio_failures(device));
    TEST_ASSERT_EQUAL_INT32(5, counts);
}

static void test_trigger_is_set_by_name(void) {
    make_buffered_device();
    accel_iio_options_t options = options_of("adxl355", true);
    options.trigger = "adxl355-dev1";
    device = accel_iio_open(&options, &accel, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(device, error.text);
    TEST_ASSERT_EQUAL_STRING("adxl355-dev1", scratch_read(DEVICE "/trigger/current_trigger"));
    accel_iio_close(device);
    device = NULL;
    TEST_ASSERT_EQUAL_INT(0, unlink(scratch_path(DEVICE "/trigger/current_trigger")));
    TEST_ASSERT_NULL(accel_iio_open(&options, &accel, &error));
    assert_one_line(&error, "cannot set the trigger 'adxl355-dev1'");
}

static void test_malformed_scan_elements_are_one_line(void) {
    static const struct {
        const char *file;
        const char *contents;
        const char *text;
    } cases[] = {
        {ELEMENTS "in_accel_x_type", "", "is no type"},
        {ELEMENTS "in_accel_x_type", "text\n", "'text' is no type"},
        {ELEMENTS "in_accel_x_type", "le:s20/32>>99999999999999999\n", "is no type"},
        {ELEMENTS "in_accel_x_index", "", "no index"},
        {ELEMENTS "in_accel_x_index", "-1\n", "no index"},
        {ELEMENTS "in_accel_x_index", "99999999999999999999\n", "no index"},
        {ELEMENTS "in_accel_x_index", "1\n", "same index"},
    };
    make_buffered_device();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        make_element("in_accel_x", "0\n", "be:s20/32>>12\n");
        scratch_write(cases[i].file, cases[i].contents);
        assert_refused("adxl355", true, cases[i].text);
    }
}

static void test_device_without_a_buffer_is_one_line(void) {
    make_axis('x', "1\n");
    assert_refused("adxl355", true, "buffer/enable: cannot write 0");
    scratch_folder(DEVICE "/buffer");
    scratch_write(DEVICE "/buffer/enable", "0\n");
    assert_refused("adxl355", true, "set use_buffer = false");
    scratch_folder(DEVICE "/scan_elements");
    assert_refused("adxl355", true, "this is no accelerometer");
}

static void test_types_are_read(void) {
    static const struct {
        const char *text;
        iio_channel_t channel;
    } good[] = {
        {"le:s20/32>>4", {.is_signed = true, .bits = 20, .storage = 4, .shift = 4}},
        {"be:u16/16>>0", {.is_big_endian = true, .bits = 16, .storage = 2}},
        {"le:S32/64>>32", {.is_signed = true, .bits = 32, .storage = 8, .shift = 32}},
        {"le:u12/16", {.bits = 12, .storage = 2}},
        {"be:s8/8>>0", {.is_big_endian = true, .is_signed = true, .bits = 8, .storage = 1}},
    };
    static const char *const bad[] = {
        "",
        "le",
        "le:",
        "me:s8/8>>0",
        "le:x8/8>>0",
        "le:s0/8>>0",
        "le:s8/0>>0",
        "le:s8/24>>0",
        "le:s16/8>>0",
        "le:s8/8>>1",
        "le:s33/64>>0",
        "le:u32/32>>0",
        "le:s8/8X2>>0",
        "le:s8/8>0",
        "le:s8/8>>",
        "le:s8/8>>0 ",
        "le:s-8/8>>0",
        "le:s99999999999999999999/8>>0",
        "le:s8/128>>0",
    };
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        iio_channel_t channel = {0};
        TEST_ASSERT_TRUE_MESSAGE(iio_parse_type(good[i].text, &channel), good[i].text);
        TEST_ASSERT_EQUAL_MEMORY(&good[i].channel, &channel, sizeof channel);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        iio_channel_t channel = {.bits = 3};
        TEST_ASSERT_FALSE_MESSAGE(iio_parse_type(bad[i], &channel), bad[i]);
        TEST_ASSERT_EQUAL_UINT32(3, channel.bits);
    }
}

static void test_scan_is_laid_out_by_index_and_size(void) {
    iio_channel_t channels[3] = {
        {.index = 4, .storage = 8}, {.index = 0, .storage = 1}, {.index = 2, .storage = 2}};
    TEST_ASSERT_EQUAL_UINT32(16, iio_lay_out(channels, 3));
    TEST_ASSERT_EQUAL_UINT32(8, channels[0].offset);
    TEST_ASSERT_EQUAL_UINT32(0, channels[1].offset);
    TEST_ASSERT_EQUAL_UINT32(2, channels[2].offset);
    iio_channel_t same[3] = {
        {.index = 0, .storage = 2}, {.index = 1, .storage = 2}, {.index = 2, .storage = 2}};
    TEST_ASSERT_EQUAL_UINT32(6, iio_lay_out(same, 3));
}

static void test_values_of_every_width_and_order(void) {
    const uint8_t scan[8] = {0x80, 0x01, 0xFF, 0x7F, 0x12, 0x34, 0x56, 0x78};
    const iio_channel_t big = {.is_big_endian = true, .is_signed = true, .bits = 16, .storage = 2};
    const iio_channel_t little = {.is_signed = true, .bits = 16, .storage = 2};
    const iio_channel_t wide = {.is_signed = true, .bits = 32, .storage = 8, .shift = 32};
    const iio_channel_t top = {.bits = 4, .storage = 4, .shift = 28};
    const iio_channel_t largest = {.bits = 31, .storage = 4, .offset = 0, .shift = 0};
    TEST_ASSERT_EQUAL_INT32(-32767, iio_value(&big, scan));
    TEST_ASSERT_EQUAL_INT32(0x0180, iio_value(&little, scan));
    TEST_ASSERT_EQUAL_INT32(0x78563412, iio_value(&wide, scan));
    TEST_ASSERT_EQUAL_INT32(7, iio_value(&top, scan));
    TEST_ASSERT_EQUAL_INT32(0x7FFF0180, iio_value(&largest, scan));
    const uint8_t lowest[4] = {0, 0, 0, 0x80};
    const iio_channel_t all = {.is_signed = true, .bits = 32, .storage = 4};
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, iio_value(&all, lowest));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_single_reads_are_of_the_file_as_it_is_now);
    RUN_TEST(test_sensor_of_one_axis_answers_on_all);
    RUN_TEST(test_contents_that_are_no_number_are_counted_and_no_sample);
    RUN_TEST(test_device_that_is_not_there_is_one_line);
    RUN_TEST(test_channel_is_read_by_itself_whatever_it_measures);
    RUN_TEST(test_channel_that_is_not_there_is_one_line);
    RUN_TEST(test_buffer_is_set_up_and_gives_the_newest_scan);
    RUN_TEST(test_one_read_of_a_flood_is_bounded);
    RUN_TEST(test_part_of_a_scan_and_a_lost_device_are_counted);
    RUN_TEST(test_trigger_is_set_by_name);
    RUN_TEST(test_malformed_scan_elements_are_one_line);
    RUN_TEST(test_device_without_a_buffer_is_one_line);
    RUN_TEST(test_types_are_read);
    RUN_TEST(test_scan_is_laid_out_by_index_and_size);
    RUN_TEST(test_values_of_every_width_and_order);
    return UNITY_END();
}
