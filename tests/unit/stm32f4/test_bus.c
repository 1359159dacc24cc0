// The image's frames on CAN1 fakes: what waits for a bus that is slow, away or off.
#include "board.h"
#include "bus.h"
#include "fake_can.h"
#include "fake_registers.h"
#include "stm32f4_can.h"
#include "unity.h"

#define ESR (CAN1_BASE + CAN_ESR)
#define TICK_US 1000u
#define DEMAND_ID 0x080u
#define MAILBOXES 3u

const stm32f4_board_t stm32f4_board = {
    .can = {.rx = PIN_B(8), .tx = PIN_B(9), .bit_rate_Hz = 500000},
};
static bus_t bus;
static node_t node;
static can_unsent_t unsent;
static uint32_t now; ///< the tick, which its frame carries

void setUp(void) {
    const clocks_t clocks = {.source = CLOCK_CRYSTAL, .apb1_Hz = 42000000u};
    fake_reset(FAKE_F405);
    fake_can_reset();
    fake_use_hook(fake_can_behave);
    bus = (bus_t){0};
    unsent = (can_unsent_t){0};
    now = 0;
    bus_open(&bus, &clocks);
    TEST_ASSERT_TRUE(bus.can.is_open);
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
}

static void tick(void) {
    const can_frame_t frame = {
        .id = DEMAND_ID, .length = 4, .data = {(uint8_t)now, (uint8_t)(now >> 8)}};
    const bus_tick_t said = {&frame, 1, TICK_US};
    now++;
    bus_put(&bus, &said, &unsent);
    bus_work(&bus, &node);
}

static void run(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        tick();
    }
}

static void test_a_bus_that_keeps_up_has_every_frame_at_once(void) {
    for (uint32_t i = 0; i < 100u; i++) {
        tick();
        TEST_ASSERT_EQUAL_UINT32(i, fake_can_carry());
    }
    TEST_ASSERT_EQUAL_UINT32(0, unsent.demands + fake_can.aborted);
}

static void test_where_there_is_no_room_the_oldest_gives_way(void) {
    can_frame_t frames[BUS_QUEUE_FRAMES + 8u];
    const bus_tick_t said = {frames, BUS_QUEUE_FRAMES + 8u, TICK_US};
    for (uint32_t i = 0; i < said.count; i++) {
        frames[i] = (can_frame_t){.id = DEMAND_ID, .length = 1, .data = {(uint8_t)i}};
    }
    bus_put(&bus, &said, &unsent);
    bus_work(&bus, &node);
    TEST_ASSERT_EQUAL_UINT32(8, unsent.demands);
    for (uint32_t i = 8; i < said.count; i++) {
        TEST_ASSERT_EQUAL_UINT32(i, fake_can_carry());
        bus_work(&bus, &node);
    }
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, fake_can_carry());
}

static void test_a_bus_that_comes_back_gets_no_old_demand(void) {
    run(1000); // nobody acknowledges: nothing goes out
    uint32_t word = fake_can_carry();
    for (; word != UINT32_MAX; word = fake_can_carry()) {
        TEST_ASSERT_TRUE((now - 1u - word) * TICK_US <= BUS_MOST_US);
        bus_work(&bus, &node);
    }
    TEST_ASSERT_TRUE(unsent.demands > 800u);
    tick();
    TEST_ASSERT_EQUAL_UINT32(now - 1u, fake_can_carry());
}

static void test_while_the_bus_is_off_nothing_waits(void) {
    run(5);
    fake_set(ESR, CAN_ESR_BOFF);
    run(5);
    TEST_ASSERT_EQUAL_UINT32(MAILBOXES, fake_can.aborted);
    TEST_ASSERT_EQUAL_UINT32(1, bus.can.bus_off_count);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, fake_can_carry());
    TEST_ASSERT_EQUAL_UINT32(7, unsent.demands); // those of the controller are not known any more
    fake_set(ESR, 0);
    tick();
    TEST_ASSERT_EQUAL_UINT32(now - 1u, fake_can_carry());
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, fake_can_carry());
}

static void test_a_slow_bus_loses_nothing_that_it_can_carry(void) {
    uint32_t next = 0;
    for (uint32_t i = 0; i < 100u; i++) { // a frame every 20 ms, one at a time
        if (i % 20u == 0u) {
            const can_frame_t frame = {.id = DEMAND_ID, .length = 1, .data = {(uint8_t)next++}};
            const bus_tick_t said = {&frame, 1, TICK_US};
            bus_put(&bus, &said, &unsent);
        } else {
            const bus_tick_t silent = {NULL, 0, TICK_US};
            bus_put(&bus, &silent, &unsent);
        }
        bus_work(&bus, &node);
        if (i % 20u == 19u) {
            TEST_ASSERT_EQUAL_UINT32(next - 1u, fake_can_carry());
        }
    }
    TEST_ASSERT_EQUAL_UINT32(0, unsent.demands + fake_can.aborted);
}

static void test_without_a_bus_nothing_is_kept(void) {
    const clocks_t clocks = {.source = CLOCK_INTERNAL_PLL, .apb1_Hz = 42000000u};
    bus = (bus_t){0};
    bus_open(&bus, &clocks);
    run(100);
    TEST_ASSERT_EQUAL_UINT32(0, bus.count + unsent.demands);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_bus_that_keeps_up_has_every_frame_at_once);
    RUN_TEST(test_where_there_is_no_room_the_oldest_gives_way);
    RUN_TEST(test_a_bus_that_comes_back_gets_no_old_demand);
    RUN_TEST(test_while_the_bus_is_off_nothing_waits);
    RUN_TEST(test_a_slow_bus_loses_nothing_that_it_can_carry);
    RUN_TEST(test_without_a_bus_nothing_is_kept);
    return UNITY_END();
}
