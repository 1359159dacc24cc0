// A damper's current where its driver is kept off: nothing of what was before is held against it.
#include "drive.h"

#include "unity.h"

static drive_t drive;
static quiesce_board_t board;

void setUp(void) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    quiesce_board_default(&board);
    drive_init(&drive, 0, &board.damper[0], &params, true);
}
void tearDown(void) {}

static void test_drive_that_is_held_expects_nothing_and_has_seen_nothing(void) {
    const quiesce_driver_t driver = {.current_mA = 900, .is_measured = true};
    quiesce_command_t out = {.current_cmd_mA = 800, .driver_enable = true};
    drive.last_command_mA = 800;
    drive.coil.bad = 7;
    drive.monitor.wrong = 5;
    drive_hold(&drive, &driver, &out);
    TEST_ASSERT_FALSE(out.driver_enable);
    TEST_ASSERT_EQUAL_INT32(800, out.current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT16(0, drive.last_command_mA);
    TEST_ASSERT_EQUAL_UINT32(0, drive.coil.bad);
    TEST_ASSERT_EQUAL_UINT32(0, drive.monitor.wrong);
}

static void test_drive_that_is_off_stays_as_it_is(void) {
    const quiesce_driver_t driver = {0};
    quiesce_command_t out = {.current_cmd_mA = 800, .driver_enable = false};
    drive.last_command_mA = 3;
    drive.coil.bad = 7;
    drive_hold(&drive, &driver, &out);
    TEST_ASSERT_EQUAL_UINT16(3, drive.last_command_mA);
    TEST_ASSERT_EQUAL_UINT32(7, drive.coil.bad);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_drive_that_is_held_expects_nothing_and_has_seen_nothing);
    RUN_TEST(test_drive_that_is_off_stays_as_it_is);
    return UNITY_END();
}
