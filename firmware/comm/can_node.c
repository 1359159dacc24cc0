#include "can_node.h"

#include <stddef.h>

#include "crc32.h"
#include "safe_current.h"

#define FALLBACK_RATE_HZ 1000u

_Static_assert(sizeof(quiesce_params_t) == 4u * QUIESCE_PARAM_COUNT, "parameters are words only");
_Static_assert(QUIESCE_CAN_AT_CURRENT_DEMAND + QUIESCE_MAX_DAMPERS - 1 ==
                   QUIESCE_CAN_AT_CURRENT_DEMAND3,
               "a message of each damper, one after the other");
_Static_assert(QUIESCE_PARAM_COUNT <= UINT8_MAX, "indices fit ServiceRequest");

uint32_t can_node_param_hash(const quiesce_params_t *params) {
    return crc32_words((const uint32_t *)(const void *)params, QUIESCE_PARAM_COUNT);
}

static uint32_t rate_Hz(const quiesce_params_t *params) {
    const uint32_t index = offsetof(quiesce_params_t, tick_rate_Hz) / sizeof(int32_t);
    return quiesce_param_allows(index, params->tick_rate_Hz) ? (uint32_t)params->tick_rate_Hz
                                                             : FALLBACK_RATE_HZ;
}

void can_node_init(can_node_t *self, const quiesce_board_t *board, const quiesce_params_t *params) {
    *self = (can_node_t){
        .param_hash = can_node_param_hash(params),
        .dampers = dampers_of_board(board),
    };
    can_receive_init(&self->receive, rate_Hz(params));
    for (int32_t i = 0; board != NULL && i < QUIESCE_SENSORS && i < board->sensors; i++) {
        self->receive.sensor[i].period_us = (uint32_t)board->sensor[i].period_us;
    }
    can_receive_use_rate(&self->receive, rate_Hz(params));
    can_service_init(&self->service, params);
    can_freeze_init(&self->freeze, safe_current_mA(board, params, 0));
    fault_record_init(&self->record, rate_Hz(params));
    can_schedule_init(&self->schedule, rate_Hz(params));
}

void can_node_use_params(can_node_t *self, const quiesce_board_t *board,
                         const quiesce_params_t *params) {
    const bool has_new_rate = rate_Hz(params) != rate_Hz(&self->service.in_effect);
    self->param_hash = can_node_param_hash(params);
    can_receive_use_rate(&self->receive, rate_Hz(params));
    can_service_use_params(&self->service, params);
    can_freeze_restart(&self->freeze, safe_current_mA(board, params, 0));
    fault_record_restart(&self->record, rate_Hz(params));
    if (has_new_rate) {
        can_schedule_init(&self->schedule, rate_Hz(params));
    }
}

void can_node_retune(can_node_t *self, const quiesce_params_t *params) {
    self->param_hash = can_node_param_hash(params);
    can_service_use_params(&self->service, params);
}

void can_node_receive(can_node_t *self, const can_frame_t *frame) {
    const can_service_held_t held = {&self->freeze, &self->record};
    if (can_receive_frame(&self->receive, frame)) {
        can_service_request(&self->service, frame, &held);
    }
}

void can_node_inputs(can_node_t *self, uint32_t ticks, can_node_inputs_t *inputs) {
    can_receive_inputs(&self->receive, ticks, inputs);
}

can_node_task_t can_node_task(const can_node_t *self) {
    return self->service.task;
}

const quiesce_params_t *can_node_staged(const can_node_t *self) {
    return &self->service.staged;
}

void can_node_answer(can_node_t *self, can_node_result_t result, uint32_t param_index) {
    can_service_answer(&self->service, result, param_index);
}

void can_node_answer_value(can_node_t *self, can_node_result_t result, int32_t value) {
    can_service_answer_value(&self->service, result, value);
}

const can_service_request_t *can_node_request(const can_node_t *self) {
    return &self->service.request;
}

const can_node_counters_t *can_node_counters(const can_node_t *self) {
    return &self->receive.counters;
}

static void raise(uint32_t *most, uint32_t value) {
    if (value > *most) {
        *most = value;
    }
}

static void watch_timing(can_node_t *self, const can_node_tick_t *tick) {
    raise(&self->lateness_max_us, tick->lateness_us);
    raise(&self->work_max_us, tick->work_us);
    raise(&self->most_cycles.work, tick->cycles.work);
    raise(&self->most_cycles.interrupt, tick->cycles.interrupt);
    self->most_cycles.core_kHz = tick->cycles.core_kHz;
}

static void pack_timing(can_node_t *self, const can_node_tick_t *tick, can_frame_t *frame) {
    can_pack_timing(tick->overruns, self->lateness_max_us, self->work_max_us, frame);
    self->lateness_max_us = 0;
    self->work_max_us = 0;
}

static bool pack_cycles(can_node_t *self, can_frame_t *frame) {
    can_pack_cycles(&self->most_cycles, frame);
    self->most_cycles.work = 0;
    self->most_cycles.interrupt = 0;
    return self->most_cycles.core_kHz > 0u;
}

// Each word of the law's report in turn.
static void pack_law(can_node_t *self, const quiesce_telemetry_t *t, const quiesce_t *controller,
                     can_frame_t *frame) {
    int32_t word[QUIESCE_REPORT_WORDS];
    const int32_t law = self->service.in_effect.law;
    const quiesce_word_t *names = quiesce_report_words(law);
    quiesce_report(controller, word);
    can_pack_law(law, t, self->report_number, word[self->report_number], frame);
    self->report_number = (self->report_number + 1u) % QUIESCE_REPORT_WORDS;
    if (names == NULL || names[self->report_number].name == NULL) {
        self->report_number = 0;
    }
}

// The data of a message that is due. Returns false iff there is nothing to say.
static bool pack(can_node_t *self, uint32_t message, const can_node_tick_t *tick,
                 const quiesce_out_t *out, const quiesce_t *controller, can_frame_t *frame) {
    const quiesce_telemetry_t *t = &out->telemetry;
    const bool is_streaming = self->service.raw_ms > 0u;
    switch (message) {
    case QUIESCE_CAN_AT_STATUS:
        can_pack_status(tick, t, is_streaming, frame);
        return true;
    case QUIESCE_CAN_AT_MOTION:
        can_pack_motion(t, frame);
        return true;
    case QUIESCE_CAN_AT_SPECTRUM_PEAK0:
    case QUIESCE_CAN_AT_SPECTRUM_PEAK1:
    case QUIESCE_CAN_AT_SPECTRUM_PEAK2:
        can_pack_peak(t, message - QUIESCE_CAN_AT_SPECTRUM_PEAK0, frame);
        return true;
    case QUIESCE_CAN_AT_LAW_STATE:
        pack_law(self, t, controller, frame);
        return true;
    case QUIESCE_CAN_AT_FAULT_FREEZE:
        return can_freeze_page(&self->freeze, frame);
    case QUIESCE_CAN_AT_LOOP_TIMING:
        pack_timing(self, tick, frame);
        return true;
    case QUIESCE_CAN_AT_LOOP_CYCLES:
        return pack_cycles(self, frame);
    case QUIESCE_CAN_AT_CAN_HEALTH:
        can_pack_health(&self->receive.counters, tick, frame);
        return true;
    case QUIESCE_CAN_AT_CAN_SHED:
        can_pack_shed(&tick->unsent, frame);
        return true;
    case QUIESCE_CAN_AT_FAULT_RECORD:
        return fault_record_page(&self->record, frame);
    case QUIESCE_CAN_AT_IDENTIFICATION:
        can_pack_identification(self->param_hash, frame);
        return true;
    case QUIESCE_CAN_AT_RAW_SAMPLE:
        can_pack_raw(tick, t->tick, frame);
        return is_streaming;
    default:
        return false;
    }
}

static void finish(uint32_t message, uint8_t *alive, can_frame_t *frame) {
    const quiesce_can_message_t *row = &quiesce_can_messages[message];
    frame->id = row->e2e.id;
    frame->length = row->e2e.length;
    frame->is_extended = false;
    frame->is_remote = false;
    if (row->is_protected) {
        e2e_protect(&row->e2e, alive, frame);
    }
}

// Each damper's, in the order of ids: they go before everything else.
static uint32_t put_demands(can_node_t *self, const quiesce_out_t *out,
                            can_frame_t frames[CAN_NODE_MAX_FRAMES]) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < QUIESCE_DAMPERS && i < self->dampers; i++) {
        const uint32_t message = QUIESCE_CAN_AT_CURRENT_DEMAND + i;
        if (can_schedule_is_due(&self->schedule, message)) {
            can_pack_demand(out->telemetry.state, out->damper[i].current_cmd_mA,
                            out->damper[i].driver_enable, &frames[count]);
            finish(message, &self->alive[message], &frames[count]);
            count++;
        }
    }
    return count;
}

// What else is sent by the clock, in the order of ids.
static const uint8_t cyclic[] = {
    QUIESCE_CAN_AT_STATUS,         QUIESCE_CAN_AT_MOTION,         QUIESCE_CAN_AT_SPECTRUM_PEAK0,
    QUIESCE_CAN_AT_SPECTRUM_PEAK1, QUIESCE_CAN_AT_SPECTRUM_PEAK2, QUIESCE_CAN_AT_LAW_STATE,
    QUIESCE_CAN_AT_FAULT_FREEZE,   QUIESCE_CAN_AT_LOOP_TIMING,    QUIESCE_CAN_AT_CAN_HEALTH,
    QUIESCE_CAN_AT_IDENTIFICATION, QUIESCE_CAN_AT_CAN_SHED,       QUIESCE_CAN_AT_LOOP_CYCLES,
    QUIESCE_CAN_AT_RAW_SAMPLE,     QUIESCE_CAN_AT_FAULT_RECORD,
};

static uint32_t put_cyclic(can_node_t *self, const can_node_tick_t *tick, const quiesce_out_t *out,
                           const quiesce_t *controller, can_frame_t frames[CAN_NODE_MAX_FRAMES]) {
    uint32_t count = put_demands(self, out, frames);
    for (uint32_t i = 0; i < sizeof cyclic; i++) {
        const uint32_t message = cyclic[i];
        if (can_schedule_is_due(&self->schedule, message) && count < CAN_NODE_MAX_FRAMES - 1u &&
            pack(self, message, tick, out, controller, &frames[count])) {
            finish(message, &self->alive[message], &frames[count]);
            count++;
        }
    }
    return count;
}

static void watch_faults(can_node_t *self, uint32_t passed_ms, const can_node_tick_t *tick,
                         const quiesce_out_t *out, const quiesce_t *controller) {
    const can_freeze_tick_t frozen = {
        .accel_counts = tick->accel_counts,
        .current_meas_mA = tick->current_meas_mA,
        .current_is_measured = tick->current_is_measured,
        .out = out,
    };
    can_freeze_watch(&self->freeze, passed_ms, &frozen);
    fault_record_watch(&self->record, tick, out);
    if (fault_record_wants_about(&self->record)) {
        const fault_record_about_t about = {
            .tick_rate_Hz = rate_Hz(&self->service.in_effect),
            .param_hash = self->param_hash,
            .table_hash = quiesce_table_hash(controller),
            .law = (uint32_t)self->service.in_effect.law,
        };
        fault_record_about(&self->record, &about);
    }
}

uint32_t can_node_tick(can_node_t *self, const can_node_tick_t *tick, const quiesce_out_t *out,
                       const quiesce_t *controller, can_frame_t frames[CAN_NODE_MAX_FRAMES]) {
    const uint32_t passed_ms = can_schedule_tick(&self->schedule);
    watch_faults(self, passed_ms, tick, out, controller);
    watch_timing(self, tick);
    uint32_t count = passed_ms > 0u ? put_cyclic(self, tick, out, controller, frames) : 0u;

    uint8_t alive;
    can_service_elapse(&self->service, passed_ms);
    if (can_service_reply(&self->service, &frames[count], &alive)) {
        finish(QUIESCE_CAN_AT_SERVICE_REPLY, &alive, &frames[count]);
        count++;
    }
    return count;
}

void can_node_farewell(can_node_t *self, uint32_t damper, int32_t safe_mA, can_frame_t *frame) {
    const uint32_t message = QUIESCE_CAN_AT_CURRENT_DEMAND + damper;
    // Nobody controls from here on: of the states with the driver off the one that is true.
    const uint32_t state = self->freeze.state;
    const bool is_stopped = state == QUIESCE_STATE_SAFE || state == QUIESCE_STATE_FAULT;
    can_pack_demand(is_stopped ? state : QUIESCE_STATE_IDLE, safe_mA, false, frame);
    finish(message, &self->alive[message], frame);
}
