// What the controller sends and when: counts, spreading, saturation.
#include "can_make.h"
#include "can_node.h"
#include "unity.h"

#include <stddef.h>
#include <string.h>

#define SECONDS 10u

static const int32_t rates_Hz[] = {500, 1000, 2000, 4000};

static can_node_t node;
static quiesce_out_t out;
static can_node_tick_t tick;
static quiesce_t controller;
static can_frame_t frames[CAN_NODE_MAX_FRAMES];

void setUp(void) {
    memset(&out, 0, sizeof out);
    memset(&tick, 0, sizeof tick);
    out.telemetry.state = QUIESCE_STATE_RUN;
}

void tearDown(void) {}

static void start(int32_t rate_Hz) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.tick_rate_Hz = rate_Hz;
    can_node_init(&node, NULL, &params);
    (void)quiesce_init(&controller, &params);
}

static void request(uint8_t operation, int32_t value) {
    const can_frame_t frame = make_request(operation, 0, value, 0);
    can_node_receive(&node, &frame);
}

typedef struct {
    uint32_t of[QUIESCE_CAN_MESSAGES];
    uint32_t worst;      ///< frames of a tick
    uint32_t worst_slow; ///< of them those of 10 ms and more, without the freeze frame
} counts_t;

static void count_tick(counts_t *counts, uint32_t count) {
    uint32_t slow = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t message = message_of(&frames[i]);
        TEST_ASSERT_TRUE(is_well_made(&frames[i]));
        TEST_ASSERT_TRUE(i == 0 || frames[i].id > frames[i - 1].id);
        counts->of[message]++;
        slow +=
            quiesce_can_messages[message].cycle_ms >= 10u && message != QUIESCE_CAN_AT_FAULT_FREEZE
                ? 1u
                : 0u;
    }
    counts->worst = count > counts->worst ? count : counts->worst;
    counts->worst_slow = slow > counts->worst_slow ? slow : counts->worst_slow;
}

static counts_t run(int32_t rate_Hz) {
    counts_t counts = {0};
    for (uint32_t i = 0; i < SECONDS * (uint32_t)rate_Hz; i++) {
        can_node_inputs_t inputs;
        can_node_inputs(&node, 1, &inputs);
        out.telemetry.tick++;
        count_tick(&counts, can_node_tick(&node, &tick, &out, &controller, frames));
    }
    return counts;
}

static uint32_t expected_count(uint32_t message, int32_t rate_Hz) {
    const uint32_t cycle_ms = quiesce_can_messages[message].cycle_ms;
    const uint32_t tick_ms = rate_Hz < 1000 ? 1000u / (uint32_t)rate_Hz : 1u;
    return SECONDS * 1000u / (cycle_ms > tick_ms ? cycle_ms : tick_ms);
}

// LoopCycles where the target counts cycles.
static bool is_sent(uint32_t message) {
    return message == QUIESCE_CAN_AT_CURRENT_DEMAND ||
           (message >= QUIESCE_CAN_AT_STATUS && message <= QUIESCE_CAN_AT_CAN_SHED &&
            message != QUIESCE_CAN_AT_FAULT_FREEZE) ||
           (message == QUIESCE_CAN_AT_LOOP_CYCLES && tick.cycles.core_kHz > 0u);
}

static void test_every_message_comes_as_often_as_it_should(void) {
    for (uint32_t r = 0; r < 8; r++) {
        const int32_t rate_Hz = rates_Hz[r % 4u];
        tick.cycles.core_kHz = r < 4u ? 0u : 168000u;
        start(rate_Hz);
        const counts_t counts = run(rate_Hz);
        for (uint32_t m = 0; m < QUIESCE_CAN_MESSAGES; m++) {
            const uint32_t expected = is_sent(m) ? expected_count(m, rate_Hz) : 0u;
            TEST_ASSERT_EQUAL_UINT32(expected, counts.of[m]);
        }
        TEST_ASSERT_EQUAL_UINT32(2, counts.worst);
        TEST_ASSERT_EQUAL_UINT32(1, counts.worst_slow);
    }
}

static void test_raw_samples_come_for_as_long_as_asked(void) {
    for (uint32_t r = 0; r < 4; r++) {
        start(rates_Hz[r]);
        request(QUIESCE_CAN_SERVICE_REQUEST_OPERATION_RAW_STREAM_CHOICE, 4);
        const counts_t counts = run(rates_Hz[r]);
        const uint32_t expected = rates_Hz[r] == 500 ? 2000u : 4000u;
        TEST_ASSERT_EQUAL_UINT32(expected, counts.of[QUIESCE_CAN_AT_RAW_SAMPLE]);
        TEST_ASSERT_EQUAL_UINT32(1, counts.of[QUIESCE_CAN_AT_SERVICE_REPLY]);
    }
}

static void test_busiest_tick_is_within_the_budget(void) {
    for (uint32_t r = 0; r < 4; r++) {
        counts_t counts = {0};
        start(rates_Hz[r]);
        request(QUIESCE_CAN_SERVICE_REQUEST_OPERATION_RAW_STREAM_CHOICE, 3600);
        for (uint32_t i = 0; i < SECONDS * (uint32_t)rates_Hz[r]; i++) {
            // A fault entered again and again, a request in every tick.
            out.telemetry.fault = i % 100u < 50u ? QUIESCE_FAULT_SENSOR_LOST : QUIESCE_FAULT_NONE;
            out.telemetry.fault_count = i / 100u;
            request(QUIESCE_CAN_SERVICE_REQUEST_OPERATION_READ_CHOICE, 0);
            count_tick(&counts, can_node_tick(&node, &tick, &out, &controller, frames));
        }
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(5, counts.worst);
        TEST_ASSERT_EQUAL_UINT32(1, counts.worst_slow);
        TEST_ASSERT_EQUAL_UINT32(SECONDS * 100u, counts.of[QUIESCE_CAN_AT_SERVICE_REPLY]);
    }
}

static void test_alive_counters_go_up_by_one(void) {
    uint32_t last = 15;
    start(1000);
    for (uint32_t i = 0; i < 100; i++) {
        struct quiesce_can_current_demand_t demand;
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(1,
                                            can_node_tick(&node, &tick, &out, &controller, frames));
        (void)quiesce_can_current_demand_unpack(&demand, frames[0].data, frames[0].length);
        TEST_ASSERT_EQUAL_UINT32((last + 1u) % 16u, demand.alive);
        last = demand.alive;
    }
}

static void test_refused_tick_rate_is_1_kHz(void) {
    start(0);
    TEST_ASSERT_EQUAL_UINT32(10000, run(1000).of[QUIESCE_CAN_AT_CURRENT_DEMAND]);
    start(INT32_MIN);
    TEST_ASSERT_EQUAL_UINT32(10000, run(1000).of[QUIESCE_CAN_AT_CURRENT_DEMAND]);
}

// The first frame of a message in the next second; fails where there is none.
static can_frame_t next(uint32_t message) {
    for (uint32_t i = 0; i < 1001; i++) {
        const uint32_t count = can_node_tick(&node, &tick, &out, &controller, frames);
        for (uint32_t k = 0; k < count; k++) {
            if (message_of(&frames[k]) == message) {
                return frames[k];
            }
        }
    }
    TEST_FAIL_MESSAGE("not sent");
    return frames[0];
}

static void fill(int32_t word) {
    out = (quiesce_out_t){.damper = {{.current_cmd_mA = word, .driver_enable = true}}};
    uint32_t *words = (uint32_t *)(void *)&out.telemetry;
    for (uint32_t i = 0; i < sizeof out.telemetry / 4u; i++) {
        words[i] = (uint32_t)word;
    }
    tick = (can_node_tick_t){
        .accel_counts = word,
        .current_meas_mA = word,
        .current_is_measured = true,
        .overruns = (uint32_t)word,
        .lateness_us = (uint32_t)word,
        .work_us = (uint32_t)word,
        .cycles = {(uint32_t)word, (uint32_t)word, (uint32_t)word},
        .unsent = {(uint32_t)word, (uint32_t)word, (uint32_t)word},
        .bus_off_count = (uint32_t)word,
        .rx_lost = (uint32_t)word,
    };
}

// A current of -1 mA is sent as 0, never as 65535.
static void check_words(int32_t word, bool is_high) {
    struct quiesce_can_current_demand_t demand;
    struct quiesce_can_status_t status;
    struct quiesce_can_law_state_t law;
    struct quiesce_can_loop_timing_t timing;
    struct quiesce_can_loop_cycles_t cycles;
    struct quiesce_can_can_health_t health;
    struct quiesce_can_raw_sample_t raw;
    struct quiesce_can_motion_t motion;
    start(1000);
    fill(word);
    request(QUIESCE_CAN_SERVICE_REQUEST_OPERATION_RAW_STREAM_CHOICE, 3600);
    (void)quiesce_can_current_demand_unpack(&demand, next(QUIESCE_CAN_AT_CURRENT_DEMAND).data, 4);
    (void)quiesce_can_status_unpack(&status, next(QUIESCE_CAN_AT_STATUS).data, 8);
    (void)quiesce_can_law_state_unpack(&law, next(QUIESCE_CAN_AT_LAW_STATE).data, 8);
    (void)quiesce_can_loop_timing_unpack(&timing, next(QUIESCE_CAN_AT_LOOP_TIMING).data, 8);
    (void)quiesce_can_loop_cycles_unpack(&cycles, next(QUIESCE_CAN_AT_LOOP_CYCLES).data, 8);
    (void)quiesce_can_can_health_unpack(&health, next(QUIESCE_CAN_AT_CAN_HEALTH).data, 8);
    (void)quiesce_can_raw_sample_unpack(&raw, next(QUIESCE_CAN_AT_RAW_SAMPLE).data, 8);
    (void)quiesce_can_motion_unpack(&motion, next(QUIESCE_CAN_AT_MOTION).data, 8);
    TEST_ASSERT_EQUAL_UINT16(is_high ? 65535 : 0, demand.current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT8(7, demand.state); // as an unsigned word
    TEST_ASSERT_EQUAL_UINT32(is_high ? 268435455 : 0, status.rms_um_s2);
    TEST_ASSERT_EQUAL_UINT8(255, status.fault_count);
    TEST_ASSERT_EQUAL_UINT16(is_high ? 65535 : 0, law.current_law_mA);
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_LAW_FUZZY, law.law);
    TEST_ASSERT_EQUAL_UINT16(65535, timing.overruns);
    TEST_ASSERT_EQUAL_UINT32(16777215, timing.lateness_max_us);
    TEST_ASSERT_EQUAL_UINT32(16777215, timing.work_max_us);
    TEST_ASSERT_EQUAL_UINT32(16777215, cycles.work_max_cycles);
    TEST_ASSERT_EQUAL_UINT16(65535, cycles.interrupt_max_cycles);
    TEST_ASSERT_EQUAL_UINT32(16777215, cycles.core_kHz);
    TEST_ASSERT_EQUAL_UINT8(255, health.bus_off_count);
    TEST_ASSERT_EQUAL_UINT16(65535, health.rejected_shape);
    TEST_ASSERT_EQUAL_INT32(is_high ? 8388607 : -8388608, raw.accel_counts);
    TEST_ASSERT_EQUAL_INT16(is_high ? 32767 : -32768, raw.current_meas_mA);
    TEST_ASSERT_EQUAL_INT32(word, motion.freq_uHz);
}

static void test_words_beyond_their_signals_saturate(void) {
    check_words(INT32_MAX, true);
    check_words(INT32_MIN, false);
}

static void test_health_counts_saturate(void) {
    struct quiesce_can_can_health_t health;
    start(1000);
    node.receive.counters = (can_node_counters_t){UINT32_MAX, 65536, 65535, 0, 0};
    (void)quiesce_can_can_health_unpack(&health, next(QUIESCE_CAN_AT_CAN_HEALTH).data, 8);
    TEST_ASSERT_EQUAL_UINT16(65535, health.rejected_crc);
    TEST_ASSERT_EQUAL_UINT16(65535, health.rejected_alive);
    TEST_ASSERT_EQUAL_UINT16(65535, health.rejected_shape);
}

// A minute of a line that takes nothing: each counter moves on, 16 bits of them with a wrap.
static void test_what_is_not_sent_is_counted_without_an_end(void) {
    struct quiesce_can_can_shed_t shed;
    start(1000);
    for (uint32_t i = 0; i < 70000; i++) {
        can_unsent_count(&tick.unsent, QUIESCE_CAN_CURRENT_DEMAND_FRAME_ID);
        can_unsent_count(&tick.unsent, QUIESCE_CAN_RAW_SAMPLE_FRAME_ID);
        can_unsent_count(&tick.unsent, QUIESCE_CAN_MOTION_FRAME_ID);
    }
    can_unsent_count(&tick.unsent, QUIESCE_CAN_CURRENT_DEMAND_FRAME_ID + 3u);
    can_unsent_count(&tick.unsent, QUIESCE_CAN_STATUS_FRAME_ID);
    can_unsent_count(&tick.unsent, QUIESCE_CAN_SERVICE_REPLY_FRAME_ID);
    can_unsent_count(&tick.unsent, QUIESCE_CAN_FAULT_FREEZE_FRAME_ID);
    can_unsent_count(&tick.unsent, QUIESCE_CAN_FAULT_RECORD_FRAME_ID);
    (void)quiesce_can_can_shed_unpack(&shed, next(QUIESCE_CAN_AT_CAN_SHED).data, 8);
    TEST_ASSERT_EQUAL_UINT16(70002 - 65536, shed.unsent_demands);
    TEST_ASSERT_EQUAL_UINT16(2, shed.unsent_answers);
    TEST_ASSERT_EQUAL_UINT32(140001, shed.unsent_telemetry);
}

static void test_timing_is_the_worst_since_the_last_report(void) {
    struct quiesce_can_loop_timing_t timing;
    start(1000);
    tick.lateness_us = 70;
    tick.work_us = 300;
    (void)can_node_tick(&node, &tick, &out, &controller, frames);
    tick.lateness_us = 10;
    tick.work_us = 20;
    (void)quiesce_can_loop_timing_unpack(&timing, next(QUIESCE_CAN_AT_LOOP_TIMING).data, 8);
    TEST_ASSERT_EQUAL_UINT32(70, timing.lateness_max_us);
    TEST_ASSERT_EQUAL_UINT32(300, timing.work_max_us);
    (void)quiesce_can_loop_timing_unpack(&timing, next(QUIESCE_CAN_AT_LOOP_TIMING).data, 8);
    TEST_ASSERT_EQUAL_UINT32(10, timing.lateness_max_us);
    TEST_ASSERT_EQUAL_UINT32(20, timing.work_max_us);
}

static void test_cycles_are_the_worst_since_the_last_report(void) {
    struct quiesce_can_loop_cycles_t cycles;
    start(1000);
    tick.cycles = (can_cycles_t){52000, 700, 168000};
    (void)can_node_tick(&node, &tick, &out, &controller, frames);
    tick.cycles = (can_cycles_t){41000, 650, 168000};
    (void)quiesce_can_loop_cycles_unpack(&cycles, next(QUIESCE_CAN_AT_LOOP_CYCLES).data, 8);
    TEST_ASSERT_EQUAL_UINT32(52000, cycles.work_max_cycles);
    TEST_ASSERT_EQUAL_UINT16(700, cycles.interrupt_max_cycles);
    TEST_ASSERT_EQUAL_UINT32(168000, cycles.core_kHz);
    (void)quiesce_can_loop_cycles_unpack(&cycles, next(QUIESCE_CAN_AT_LOOP_CYCLES).data, 8);
    TEST_ASSERT_EQUAL_UINT32(41000, cycles.work_max_cycles);
    TEST_ASSERT_EQUAL_UINT16(650, cycles.interrupt_max_cycles);
}

static void test_peaks_have_their_own_messages(void) {
    start(1000);
    for (int32_t i = 0; i < 3; i++) {
        out.telemetry.peaks[i] = (quiesce_peak_t){1000 + i, -7 - i, 5};
    }
    for (uint32_t i = 0; i < 3; i++) {
        struct quiesce_can_spectrum_peak0_t peak;
        const can_frame_t frame = next(QUIESCE_CAN_AT_SPECTRUM_PEAK0 + i);
        (void)quiesce_can_spectrum_peak0_unpack(&peak, frame.data, frame.length);
        TEST_ASSERT_EQUAL_INT32(1000 + (int32_t)i, peak.peak0_freq_uHz);
        TEST_ASSERT_EQUAL_INT32(-7 - (int32_t)i, peak.peak0_amp_um_s2);
    }
}

static void test_farewell_is_a_demand_of_the_safe_current_with_the_output_off(void) {
    struct quiesce_can_current_demand_t demand;
    can_frame_t frame;
    start(1000);
    out.damper[0].current_cmd_mA = 3000;
    out.damper[0].driver_enable = true;
    (void)can_node_tick(&node, &tick, &out, &controller, frames);
    can_node_farewell(&node, 0, 250, &frame);
    TEST_ASSERT_TRUE(is_well_made(&frame));
    (void)quiesce_can_current_demand_unpack(&demand, frame.data, frame.length);
    TEST_ASSERT_EQUAL_UINT16(250, demand.current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT8(0, demand.driver_is_enabled);
    TEST_ASSERT_EQUAL_UINT8(1, demand.alive);
}

/// Nobody runs once the output is off.
static void test_farewell_says_the_state_that_is_true(void) {
    static const struct {
        uint32_t last;
        uint32_t said;
    } rows[] = {
        {QUIESCE_STATE_INIT, QUIESCE_STATE_IDLE},   {QUIESCE_STATE_IDLE, QUIESCE_STATE_IDLE},
        {QUIESCE_STATE_RUN, QUIESCE_STATE_IDLE},    {QUIESCE_STATE_SAFE, QUIESCE_STATE_SAFE},
        {QUIESCE_STATE_FAULT, QUIESCE_STATE_FAULT},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        struct quiesce_can_current_demand_t demand;
        can_frame_t frame;
        start(1000);
        out.telemetry.state = rows[i].last;
        (void)can_node_tick(&node, &tick, &out, &controller, frames);
        can_node_farewell(&node, 0, 0, &frame);
        (void)quiesce_can_current_demand_unpack(&demand, frame.data, frame.length);
        TEST_ASSERT_EQUAL_UINT8(rows[i].said, demand.state);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_message_comes_as_often_as_it_should);
    RUN_TEST(test_raw_samples_come_for_as_long_as_asked);
    RUN_TEST(test_busiest_tick_is_within_the_budget);
    RUN_TEST(test_alive_counters_go_up_by_one);
    RUN_TEST(test_refused_tick_rate_is_1_kHz);
    RUN_TEST(test_words_beyond_their_signals_saturate);
    RUN_TEST(test_health_counts_saturate);
    RUN_TEST(test_what_is_not_sent_is_counted_without_an_end);
    RUN_TEST(test_timing_is_the_worst_since_the_last_report);
    RUN_TEST(test_cycles_are_the_worst_since_the_last_report);
    RUN_TEST(test_peaks_have_their_own_messages);
    RUN_TEST(test_farewell_is_a_demand_of_the_safe_current_with_the_output_off);
    RUN_TEST(test_farewell_says_the_state_that_is_true);
    return UNITY_END();
}
