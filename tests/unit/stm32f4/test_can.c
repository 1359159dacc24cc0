// CAN1 on fakes: the manual's mailboxes, FIFO and flags.
#include "can_stm32f4.h"
#include "fake_can.h"
#include "fake_registers.h"
#include "stm32f4_can.h"
#include "unity.h"

#define CAN(r) (CAN1_BASE + (r))
#define BUS_Hz 42000000u

static can_stm32f4_t can;
static const can_wiring_t wiring = {.rx = PIN_B(8), .tx = PIN_B(9), .bit_rate_Hz = 500000};

void setUp(void) {
    fake_reset(FAKE_F405);
    fake_can_reset();
    fake_use_hook(fake_can_behave);
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
}

static void open(void) {
    TEST_ASSERT_TRUE(can_stm32f4_open(&can, &wiring, BUS_Hz));
}

static void test_bit_rates_are_exact_and_sampled_late(void) {
    static const uint32_t rates_Hz[] = {125000, 250000, 500000, 1000000};
    for (uint32_t i = 0; i < sizeof rates_Hz / sizeof rates_Hz[0]; i++) {
        const can_wiring_t one = {.rx = PIN_B(8), .tx = PIN_B(9), .bit_rate_Hz = rates_Hz[i]};
        TEST_ASSERT_TRUE(can_stm32f4_open(&can, &one, BUS_Hz));
        const uint32_t btr = fake_get(CAN(CAN_BTR));
        const uint32_t divider = ((btr & CAN_BTR_BRP) >> CAN_BTR_BRP_AT) + 1u;
        const uint32_t before = ((btr & CAN_BTR_TS1) >> CAN_BTR_TS1_AT) + 1u;
        const uint32_t after = ((btr & CAN_BTR_TS2) >> CAN_BTR_TS2_AT) + 1u;
        const uint32_t quanta = 1u + before + after;
        TEST_ASSERT_EQUAL_UINT32(BUS_Hz, divider * quanta * rates_Hz[i]);
        TEST_ASSERT_TRUE(8u * (1u + before) >= 6u * quanta &&
                         8u * (1u + before) <= 7u * quanta + 4u);
        TEST_ASSERT_BITS_LOW(CAN_BTR_LBKM | CAN_BTR_SILM, btr);
    }
}

static void test_what_cannot_be_made_is_refused(void) {
    const can_wiring_t none = {.bit_rate_Hz = 0};
    const can_wiring_t odd = {.bit_rate_Hz = 499999};
    can_frame_t frame = {0};
    TEST_ASSERT_FALSE(can_stm32f4_open(&can, &none, BUS_Hz));
    TEST_ASSERT_FALSE(can_stm32f4_open(&can, &odd, BUS_Hz));
    TEST_ASSERT_EQUAL_UINT32(0, fake_all_writes());
    fake_can.is_deaf = true;
    TEST_ASSERT_FALSE(can_stm32f4_open(&can, &wiring, BUS_Hz)); // and does not hang
    TEST_ASSERT_FALSE(can_stm32f4_send(&can, &frame));
    TEST_ASSERT_FALSE(can_stm32f4_receive(&can, &frame));
    fake_absent();
    TEST_ASSERT_FALSE(can_stm32f4_open(&can, &wiring, BUS_Hz));
}

static void test_it_lets_all_through_and_leaves_its_initialisation(void) {
    open();
    TEST_ASSERT_BITS_HIGH(CAN_MCR_ABOM, fake_get(CAN(CAN_MCR)));
    TEST_ASSERT_BITS_LOW(CAN_MCR_INRQ | CAN_MCR_SLEEP | CAN_MCR_NART, fake_get(CAN(CAN_MCR)));
    TEST_ASSERT_EQUAL_UINT32(1, fake_get(CAN(CAN_FA1R)) & 1u);
    TEST_ASSERT_EQUAL_UINT32(1, fake_get(CAN(CAN_FS1R)) & 1u);
    TEST_ASSERT_EQUAL_UINT32(0, fake_get(CAN(CAN_FM1R)) & 1u);
    TEST_ASSERT_EQUAL_HEX32(0, fake_get(CAN(CAN_FB_FR2(0u))));
    TEST_ASSERT_BITS_LOW(CAN_FMR_FINIT, fake_get(CAN(CAN_FMR)));
}

static void test_frames_are_received_as_they_were_sent(void) {
    can_frame_t frame = {0};
    open();
    TEST_ASSERT_FALSE(can_stm32f4_receive(&can, &frame));
    fake_can.waiting = 2;
    fake_can_put_levels();
    fake_set(CAN(CAN_RX_RIR(0u)), 0x123u << 21);
    fake_set(CAN(CAN_RX_RDTR(0u)), 5);
    fake_set(CAN(CAN_RX_RDLR(0u)), 0x44332211u);
    fake_set(CAN(CAN_RX_RDHR(0u)), 0x88776655u);
    const uint8_t five[8] = {0x11, 0x22, 0x33, 0x44, 0x55, 0, 0, 0};
    TEST_ASSERT_TRUE(can_stm32f4_receive(&can, &frame));
    TEST_ASSERT_EQUAL_HEX32(0x123, frame.id);
    TEST_ASSERT_EQUAL_UINT8(5, frame.length);
    TEST_ASSERT_FALSE(frame.is_extended || frame.is_remote);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(five, frame.data, 8);
    fake_set(CAN(CAN_RX_RIR(0u)), 0x1ABCDEF0u << 3 | CAN_RX_RIR_IDE | CAN_RX_RIR_RTR);
    fake_set(CAN(CAN_RX_RDTR(0u)), 15); // more than 8 are 8
    TEST_ASSERT_TRUE(can_stm32f4_receive(&can, &frame));
    TEST_ASSERT_EQUAL_HEX32(0x1ABCDEF0, frame.id);
    TEST_ASSERT_EQUAL_UINT8(8, frame.length);
    TEST_ASSERT_TRUE(frame.is_extended && frame.is_remote);
    TEST_ASSERT_EQUAL_HEX8(0, frame.data[0]);
    TEST_ASSERT_FALSE(can_stm32f4_receive(&can, &frame));
}

static void test_three_frames_are_taken_and_a_fourth_is_not(void) {
    can_frame_t frame = {.id = 0x7FF, .length = 3, .data = {1, 2, 3}};
    open();
    TEST_ASSERT_TRUE(can_stm32f4_send(&can, &frame));
    TEST_ASSERT_EQUAL_HEX32(0x7FFu << 21 | 1u, fake_get(CAN(CAN_TX_TIR(0u))));
    TEST_ASSERT_EQUAL_UINT32(3, fake_get(CAN(CAN_TX_TDTR(0u))));
    TEST_ASSERT_EQUAL_HEX32(0x00030201u, fake_get(CAN(CAN_TX_TDLR(0u))));
    frame = (can_frame_t){.id = 0x1FFFFFFF, .is_extended = true, .is_remote = true};
    TEST_ASSERT_TRUE(can_stm32f4_send(&can, &frame));
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFFu, fake_get(CAN(CAN_TX_TIR(1u))));
    TEST_ASSERT_TRUE(can_stm32f4_send(&can, &frame));
    TEST_ASSERT_FALSE(can_stm32f4_send(&can, &frame));
    TEST_ASSERT_EQUAL_UINT32(3, fake_can.sent);
    fake_set(CAN(CAN_TSR), CAN_TSR_TME1);
    TEST_ASSERT_TRUE(can_stm32f4_send(&can, &frame));
    TEST_ASSERT_EQUAL_UINT32(4, fake_can.sent);
}

static void test_frames_of_one_identifier_go_out_in_their_order(void) {
    can_frame_t frame = {.id = 0x100, .length = 1};
    open();
    for (uint32_t i = 0; i < 12u; i++) { // mailboxes are filled as they become free
        frame.data[0] = (uint8_t)i;
        if (!can_stm32f4_send(&can, &frame)) {
            TEST_ASSERT_EQUAL_UINT32(i - 3u, fake_can_carry());
            TEST_ASSERT_TRUE(can_stm32f4_send(&can, &frame));
        }
    }
    frame = (can_frame_t){.id = 0x001, .length = 1, .data = {12}};
    TEST_ASSERT_EQUAL_UINT32(9, fake_can_carry());
    TEST_ASSERT_TRUE(can_stm32f4_send(&can, &frame));
    for (uint32_t i = 10; i < 13u; i++) {
        TEST_ASSERT_EQUAL_UINT32(i, fake_can_carry());
    }
}

static void test_frames_on_their_way_are_taken_back(void) {
    const can_frame_t frame = {.id = 0x100, .length = 1};
    open();
    TEST_ASSERT_EQUAL_HEX32(0, can_stm32f4_waiting(&can));
    TEST_ASSERT_TRUE(can_stm32f4_send(&can, &frame));
    TEST_ASSERT_TRUE(can_stm32f4_send(&can, &frame));
    TEST_ASSERT_EQUAL_HEX32(CAN_TSR_TME0 | CAN_TSR_TME1, can_stm32f4_waiting(&can));
    can_stm32f4_abort(&can);
    TEST_ASSERT_EQUAL_UINT32(2, fake_can.aborted);
    TEST_ASSERT_EQUAL_HEX32(0, can_stm32f4_waiting(&can));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, fake_can_carry());
}

static void test_bus_off_and_lost_frames_are_counted_once_each(void) {
    open();
    can_stm32f4_watch(&can);
    fake_set(CAN(CAN_ESR), CAN_ESR_BOFF);
    can_stm32f4_watch(&can);
    can_stm32f4_watch(&can);
    TEST_ASSERT_EQUAL_UINT32(1, can.bus_off_count);
    fake_set(CAN(CAN_ESR), 0);
    can_stm32f4_watch(&can);
    fake_set(CAN(CAN_ESR), CAN_ESR_BOFF);
    can_stm32f4_watch(&can);
    TEST_ASSERT_EQUAL_UINT32(2, can.bus_off_count);
    fake_set(CAN(CAN_RF0R), CAN_RF0R_FOVR);
    can_stm32f4_watch(&can);
    can_stm32f4_watch(&can);
    TEST_ASSERT_EQUAL_UINT32(1, can.rx_lost);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_bit_rates_are_exact_and_sampled_late);
    RUN_TEST(test_what_cannot_be_made_is_refused);
    RUN_TEST(test_it_lets_all_through_and_leaves_its_initialisation);
    RUN_TEST(test_frames_are_received_as_they_were_sent);
    RUN_TEST(test_three_frames_are_taken_and_a_fourth_is_not);
    RUN_TEST(test_frames_of_one_identifier_go_out_in_their_order);
    RUN_TEST(test_frames_on_their_way_are_taken_back);
    RUN_TEST(test_bus_off_and_lost_frames_are_counted_once_each);
    return UNITY_END();
}
