// Frames that other nodes send: their protection, their time, what they say.
#include "can_receive.h"
#include "e2e.h"
#include "freshness.h"
#include "part.h"
#include "part_cases.h"

enum { CASES = 24, FRAMES = 4000, TICKS = 6000 };

static void draw_data(part_t *part, can_frame_t *frame) {
    for (uint32_t i = 0; i < sizeof frame->data; i++) {
        frame->data[i] = (uint8_t)draw_below(&part->seed, 256);
    }
}

// A frame of a message; its alive counter counts on.
static void draw_frame(part_t *part, uint32_t message, uint8_t *alive, can_frame_t *frame) {
    const e2e_layout_t *const layout = &quiesce_can_messages[message].e2e;
    *frame = (can_frame_t){.id = layout->id, .length = layout->length};
    draw_data(part, frame);
    e2e_protect(layout, alive, frame);
}

// One of what goes wrong on a bus.
static void spoil(part_t *part, can_frame_t *frame) {
    uint32_t bit;
    switch (draw_below(&part->seed, 5)) {
    case 0:
        bit = draw_below(&part->seed, 64);
        frame->data[bit / 8u] ^= (uint8_t)(1u << bit % 8u);
        break;
    case 1:
        frame->length = (uint8_t)draw_below(&part->seed, 9);
        break;
    case 2:
        frame->id ^= 1u << draw_below(&part->seed, 11);
        break;
    case 3:
        frame->is_remote = true;
        break;
    default:
        frame->is_extended = true;
        break;
    }
}

static void e2e_case(uint32_t number) {
    part_t part;
    uint8_t alive = (uint8_t)number % 16u;
    part_open(&part, "e2e", number);
    const uint32_t message = number % QUIESCE_CAN_MESSAGES;
    const e2e_layout_t *const layout = &quiesce_can_messages[message].e2e;
    for (uint32_t i = 0; i < FRAMES && layout->length > 0; i++) {
        can_frame_t frame;
        draw_frame(&part, message, &alive, &frame);
        for (uint32_t k = 0; k < sizeof frame.data; k++) {
            part_word(&part, frame.data[k]);
        }
        part_word(&part, e2e_alive(layout, &frame));
        part_word(&part, e2e_crc(layout, &frame));
        if (part_one_in(&part, 2)) {
            spoil(&part, &frame);
        }
        part_word(&part, e2e_check(layout, &frame));
        part_word(&part, alive);
    }
    part_close(&part);
}

// To when the frame after `step` cycles is due, or a limit of what counts.
static int32_t draw_pause_us(part_t *part, const freshness_t *row, uint32_t step) {
    const int32_t edges_us[] = {0,
                                0,
                                0,
                                0,
                                row->tolerance_us,
                                row->drift_us,
                                row->tolerance_us + row->drift_us,
                                row->tolerance_us / 4 + row->drift_us,
                                row->cycle_us / 2,
                                row->timeout_us};
    const int32_t edge_us = edges_us[draw_below(&part->seed, sizeof edges_us / sizeof *edges_us)];
    const int64_t due_us = (int64_t)step * row->cycle_us - row->since_due_us;
    const int32_t pause_us =
        part_near(part, part_one_in(part, 2) ? due_us + edge_us : due_us - edge_us);
    return pause_us > 0 ? pause_us : 0;
}

static void use_times(part_t *part, freshness_t *row) {
    const int32_t cycle_us = part_edge(part, 1, part_one_in(part, 2) ? 10000000 : 20000);
    const int32_t most_us = 15 * cycle_us - cycle_us / 4 * 3 - FRESHNESS_JITTER_US - cycle_us / 8;
    const int32_t timeout_us =
        part_edge(part, cycle_us, most_us > cycle_us + 1 ? most_us - 1 : cycle_us);
    freshness_use(row, cycle_us, timeout_us);
    part_word(part, row->tolerance_us);
    part_word(part, row->drift_us);
}

static void freshness_case(uint32_t number) {
    part_t part;
    freshness_t row = {0};
    part_open(&part, "freshness", number);
    use_times(&part, &row);
    for (uint32_t i = 0; i < FRAMES; i++) {
        const uint32_t usual = part_one_in(&part, 12) ? 2u + draw_below(&part.seed, 14) : 1u;
        const uint32_t step = part_one_in(&part, 20) ? 0u : usual;
        if (!part_one_in(&part, 10)) {
            freshness_pass(&row, draw_pause_us(&part, &row, step));
        } else if (part_one_in(&part, 4)) {
            freshness_pass(&row, part_edge(&part, 0, INT32_MAX));
        }
        part_word(&part, freshness_is_known(&row));
        const uint32_t content = part_one_in(&part, 3) ? row.content : draw_below(&part.seed, 2);
        part_word(&part, freshness_judge(&row, (uint8_t)((row.alive + step) % 16u), content));
        part_word(&part, freshness_is_known(&row));
        if (part_one_in(&part, 1000)) {
            use_times(&part, &row);
        }
        if (part_one_in(&part, 6)) { // how long it holds, to the microsecond
            freshness_t later = row;
            const int32_t held_us = part_near(&part, row.left_us);
            freshness_pass(&later, held_us > 0 ? held_us : 0);
            part_word(&part, freshness_is_known(&later));
        }
    }
    part_close(&part);
}

typedef struct {
    uint32_t message;
    uint8_t alive;
    int32_t due_us;
} sender_t;

enum { SENDERS = 3 + QUIESCE_SENSORS + QUIESCE_DAMPERS };

static void draw_senders(part_t *part, sender_t *senders) {
    uint32_t count = 0;
    senders[count++].message = QUIESCE_CAN_AT_EMERGENCY_STOP;
    senders[count++].message = QUIESCE_CAN_AT_OPERATOR_COMMAND;
    senders[count++].message = QUIESCE_CAN_AT_SERVICE_REQUEST;
    for (uint32_t i = 0; i < QUIESCE_SENSORS; i++) {
        senders[count++].message = QUIESCE_CAN_AT_ACCEL_SAMPLE + i;
    }
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        senders[count++].message = QUIESCE_CAN_AT_CURRENT_MEASURED + i;
    }
    for (uint32_t i = 0; i < SENDERS; i++) {
        senders[i].alive = (uint8_t)draw_below(&part->seed, 16);
        senders[i].due_us = 0;
    }
}

static int32_t cycle_us_of(const can_receive_t *bus, uint32_t message) {
    const uint32_t sensor = message - QUIESCE_CAN_AT_ACCEL_SAMPLE;
    const uint32_t cycle_ms = quiesce_can_messages[message].cycle_ms;
    const uint32_t period_us = sensor < QUIESCE_SENSORS ? bus->sensor[sensor].period_us : 0;
    return period_us > 0u ? (int32_t)period_us : cycle_ms > 0u ? (int32_t)cycle_ms * 1000 : 100000;
}

// The last frame again, with other bytes behind its end, at times with a bit of what it says
// changed under the same counter.
static void repeat(part_t *part, can_receive_t *bus, const sender_t *sender,
                   const can_frame_t *last) {
    can_frame_t frame = *last;
    uint8_t alive = (sender->alive + 15u) % 16u;
    for (uint32_t i = frame.length; i < sizeof frame.data; i++) {
        frame.data[i] = (uint8_t)draw_below(&part->seed, 256);
    }
    if (part_one_in(part, 2)) {
        const uint32_t bit = draw_below(&part->seed, 40);
        frame.data[bit / 8u] ^= (uint8_t)(1u << bit % 8u);
        e2e_protect(&quiesce_can_messages[sender->message].e2e, &alive, &frame);
    }
    part_word(part, can_receive_frame(bus, &frame));
}

// What is due in this tick: mostly as it should be, at times nothing, twice or spoilt.
static void send(part_t *part, can_receive_t *bus, sender_t *sender) {
    can_frame_t frame;
    sender->due_us -= bus->tick_us;
    if (sender->due_us > 0) {
        return;
    }
    sender->due_us += cycle_us_of(bus, sender->message);
    if (sender->message == QUIESCE_CAN_AT_EMERGENCY_STOP && !part_one_in(part, 20)) {
        return;
    }
    draw_frame(part, sender->message, &sender->alive, &frame);
    const bool is_spoilt = part_one_in(part, 30);
    if (is_spoilt) {
        spoil(part, &frame);
    }
    if (!part_one_in(part, 40)) {
        part_word(part, can_receive_frame(bus, &frame));
    }
    if (part_one_in(part, 40)) {
        repeat(part, bus, sender, &frame);
    }
    if (part_one_in(part, 60)) {
        sender->alive = (uint8_t)draw_below(&part->seed, 16);
    }
    if (part_one_in(part, 200)) {
        sender->due_us += part_edge(part, 0, 400000);
    }
}

// Held as an operator holds it: random bits would never be the same in a row.
static void hold(part_t *part, can_receive_t *bus, sender_t *panel, uint8_t *held) {
    const e2e_layout_t *const layout = &quiesce_can_messages[QUIESCE_CAN_AT_OPERATOR_COMMAND].e2e;
    can_frame_t frame = {.id = layout->id, .length = layout->length};
    panel->due_us -= bus->tick_us;
    if (panel->due_us > 0) {
        return;
    }
    panel->due_us += cycle_us_of(bus, panel->message);
    *held ^= part_one_in(part, 6) ? 1u : 0u;
    *held ^= part_one_in(part, 3) ? 2u : 0u;
    frame.data[0] = *held;
    e2e_protect(layout, &panel->alive, &frame);
    if (!part_one_in(part, 25)) {
        part_word(part, can_receive_frame(bus, &frame));
    }
    if (part_one_in(part, 40)) {
        repeat(part, bus, panel, &frame);
    }
}

static void record_inputs(part_t *part, const can_node_inputs_t *in) {
    part_word(part, in->enable);
    part_word(part, in->fault_reset);
    part_word(part, in->estop);
    for (uint32_t i = 0; i < QUIESCE_SENSORS; i++) {
        part_word(part, in->sensor[i].counts);
        part_word(part, in->sensor[i].is_fresh);
        part_word(part, in->sensor[i].is_saturated);
    }
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        part_word(part, in->driver[i].current_mA);
        part_word(part, in->driver[i].is_measured);
        part_word(part, in->driver[i].has_failed);
    }
}

static void record_counters(part_t *part, const can_node_counters_t *counters) {
    part_word(part, counters->rejected_crc);
    part_word(part, counters->rejected_alive);
    part_word(part, counters->rejected_shape);
    part_word(part, counters->unknown);
    part_word(part, counters->accepted);
}

static void receive_case(uint32_t number) {
    static const uint32_t rates_Hz[] = {500, 1000, 2000, 4000};
    part_t part;
    can_receive_t bus;
    sender_t senders[SENDERS];
    uint8_t held = 0;
    part_open(&part, "receive", number);
    can_receive_init(&bus, rates_Hz[number % 4u]);
    bus.sensor[0].period_us = part_one_in(&part, 2) ? 0u : (uint32_t)part_edge(&part, 1, 50000);
    can_receive_use_rate(&bus, rates_Hz[number % 4u]);
    draw_senders(&part, senders);
    for (uint32_t i = 0; i < TICKS; i++) {
        can_node_inputs_t inputs;
        for (uint32_t k = 0; k < SENDERS; k++) {
            if (senders[k].message == QUIESCE_CAN_AT_OPERATOR_COMMAND) {
                hold(&part, &bus, &senders[k], &held);
            } else {
                send(&part, &bus, &senders[k]);
            }
        }
        uint32_t ticks = part_one_in(&part, 50) ? 1u + draw_below(&part.seed, 300) : 1u;
        ticks = part_one_in(&part, 3000) ? UINT32_MAX - draw_below(&part.seed, 2) : ticks;
        can_receive_inputs(&bus, ticks, &inputs);
        record_inputs(&part, &inputs);
        record_counters(&part, &bus.counters);
        if (part_one_in(&part, 2000)) {
            can_receive_use_rate(&bus, rates_Hz[draw_below(&part.seed, 4)]);
        }
        if (part_one_in(&part, 3000)) {
            bus.counters.accepted = UINT32_MAX;
        }
    }
    part_close(&part);
}

void part_frame_cases(void) {
    for (uint32_t number = 0; number < CASES; number++) {
        e2e_case(number);
        freshness_case(number);
        receive_case(number);
    }
}
