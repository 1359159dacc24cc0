// libFuzzer: any frames and any SLCAN bytes, between ticks of a whole controller with its messages.
// Whatever arrives, a tick's frames are within the budget, well made and in order; and a frame that
// is malformed or of a wrong CRC changes nothing but its counter.
#include "can_make.h"
#include "node.h"
#include "slcan.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/// Of a structured input: kind, then what a frame needs.
#define RECORD_BYTES 16u
/// Demand, raw sample, page of the freeze frame, reply, one other: phases keep those apart.
#define MOST_FRAMES 5u

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static node_t node;

static void require(bool holds) {
    if (!holds) {
        abort();
    }
}

static bool is_taken(const can_frame_t *frame) {
    const uint32_t message = message_of(frame);
    if (message - QUIESCE_CAN_AT_ACCEL_SAMPLE < QUIESCE_SENSORS ||
        message - QUIESCE_CAN_AT_CURRENT_MEASURED < QUIESCE_DAMPERS) {
        return true;
    }
    switch (message) {
    case QUIESCE_CAN_AT_EMERGENCY_STOP:
    case QUIESCE_CAN_AT_OPERATOR_COMMAND:
    case QUIESCE_CAN_AT_SERVICE_REQUEST:
        return true;
    default:
        return false;
    }
}

static void receive(const can_frame_t *frame) {
    static node_t before;
    memcpy(&before, &node, sizeof node);
    node_receive(&node, frame);
    if (!is_taken(frame) || !is_well_made(frame)) {
        before.can.receive.counters = node.can.receive.counters;
        require(memcmp(&before, &node, sizeof node) == 0);
    }
}

// The demand frame, where there is one, says what a driver on the board would be told.
static bool is_command(const can_frame_t *frame) {
    struct quiesce_can_current_demand_t wire;
    if (frame->id != QUIESCE_CAN_CURRENT_DEMAND_FRAME_ID) {
        return true;
    }
    (void)quiesce_can_current_demand_unpack(&wire, frame->data, frame->length);
    return wire.current_cmd_mA == node.out.damper[0].current_cmd_mA &&
           wire.driver_is_enabled == (node.out.damper[0].driver_enable ? 1u : 0u);
}

static void tick(uint8_t flags) {
    const node_inputs_t board = {
        .enable = (flags & 1u) != 0,
        .estop = (flags & 0xF0u) == 0xF0u,
        .fault_reset = (flags & 2u) != 0,
        .sensor = {{.counts = (int32_t)(flags * 2654435761u) >> 8, .is_fresh = (flags & 4u) != 0}},
        .ticks_elapsed = 1u + (flags >> 6) % 3u,
    };
    can_frame_t frames[NODE_MAX_FRAMES];
    const uint32_t count = node_tick(&node, &board, frames);
    require(count <= MOST_FRAMES);
    for (uint32_t i = 0; i < count; i++) {
        require(is_well_made(&frames[i]));
        require(i == 0 || frames[i].id > frames[i - 1u].id);
    }
    require(node.out.damper[0].current_cmd_mA >= 0);
    require(count == 0 || is_command(&frames[0]));
}

static int32_t word_at(const uint8_t *bytes) {
    return (int32_t)((uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
                     (uint32_t)bytes[3] << 24);
}

static can_frame_t any_frame(const uint8_t *record) {
    can_frame_t frame = {
        .id = (uint32_t)word_at(&record[2]),
        .length = record[6],
        .is_extended = (record[7] & 1u) != 0,
        .is_remote = (record[7] & 2u) != 0,
    };
    if ((record[7] & 4u) != 0) { // one of the bus
        frame.id = quiesce_can_messages[record[2] % QUIESCE_CAN_MESSAGES].e2e.id;
        frame.length = record[6] % 9u;
    }
    memcpy(frame.data, &record[8], CAN_MAX_BYTES);
    return frame;
}

static can_frame_t good_frame(const uint8_t *record) {
    const int32_t value = word_at(&record[4]);
    switch (record[1] % 5u) {
    case 0:
        return make_stop(record[3] % 2u != 0 ? QUIESCE_CAN_EMERGENCY_STOP_CODE_STOP_CHOICE
                                             : (uint16_t)(value & UINT16_MAX),
                         record[2]);
    case 1:
        return make_accel(value >> 8, (value & 1) != 0, (value & 2) != 0, record[2]);
    case 2:
        return make_current((int16_t)(value >> 16), record[2]);
    case 3:
        return make_operator((value & 1) != 0, (value & 2) != 0, record[2]);
    default:
        return make_request(record[3], record[8], value, record[2]);
    }
}

static void run_record(const uint8_t *record) {
    can_frame_t frame;
    switch (record[0] % 4u) {
    case 0:
        tick(record[1]);
        break;
    case 1:
        frame = any_frame(record);
        receive(&frame);
        break;
    case 2:
        frame = good_frame(record);
        receive(&frame);
        break;
    default: // one bit wrong
        frame = good_frame(record);
        frame.data[record[9] % frame.length] ^= (uint8_t)(1u << record[10] % 8u);
        receive(&frame);
        break;
    }
}

// Bytes of a serial line; every zero byte is a tick.
static void run_stream(const uint8_t *bytes, size_t count) {
    slcan_decoder_t decoder;
    can_frame_t frame;
    slcan_decoder_init(&decoder);
    for (size_t i = 0; i < count; i++) {
        if (bytes[i] == 0) {
            tick(1);
        } else if (slcan_decode(&decoder, bytes[i], &frame)) {
            receive(&frame);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    memset(&node, 0, sizeof node);
    const node_sources_t from = {
        .enable = count == 0 ? NODE_ENABLE_BOARD : (node_enable_t)(bytes[0] >> 1) % 3,
        .sensors_on_bus = count > 0 && (bytes[0] & 8u) != 0 ? 1u : 0u,
    };
    require(count == 0 || node_init(&node, NULL, &params, from));
    if (count > 0 && bytes[0] % 2u == 0) {
        run_stream(&bytes[1], count - 1u);
        return 0;
    }
    for (size_t at = 1; at + RECORD_BYTES <= count; at += RECORD_BYTES) {
        run_record(&bytes[at]);
    }
    return 0;
}
