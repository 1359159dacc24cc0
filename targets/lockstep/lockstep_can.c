#include "lockstep_can.h"

#include <stddef.h>
#include <string.h>

_Static_assert(sizeof(lockstep_reply_t) - offsetof(lockstep_reply_t, telemetry) ==
                   4u * QUIESCE_CAN_TELEMETRY_WORDS,
               "quiesce.dbc has one telemetry message a word");
_Static_assert(QUIESCE_PARAM_COUNT <= UINT8_MAX, "indices fit LockstepStatus");

static void count_up(uint16_t *counter) {
    if (*counter < UINT16_MAX) {
        (*counter)++;
    }
}

static uint32_t reject(lockstep_can_t *self) {
    count_up(&self->unknown_frames);
    return 0;
}

static void put_status(const lockstep_can_t *self, can_frame_t *out) {
    const struct quiesce_can_lockstep_status_t status = {
        .is_started = self->is_started,
        .param_is_refused = self->param_is_refused,
        .refused_index = self->refused_index,
        .param_count = QUIESCE_PARAM_COUNT,
        .telemetry_words = QUIESCE_CAN_TELEMETRY_WORDS,
        .unknown_frames = self->unknown_frames,
        .sequence_errors = self->sequence_errors,
    };
    *out = (can_frame_t){
        .id = QUIESCE_CAN_LOCKSTEP_STATUS_FRAME_ID,
        .length = QUIESCE_CAN_LOCKSTEP_STATUS_LENGTH,
    };
    (void)quiesce_can_lockstep_status_pack(out->data, &status, sizeof out->data);
}

static void start(lockstep_can_t *self, const struct quiesce_can_lockstep_control_t *control) {
    quiesce_param_error_t error;
    self->param_is_refused = !quiesce_params_check(&self->params, &error);
    self->refused_index = self->param_is_refused ? (uint8_t)error.index : 0u;
    (void)lockstep_start(&self->server, &self->params);
    self->telemetry_every_ticks = control->telemetry_every_ticks;
    self->telemetry_frames = control->telemetry_frames;
    self->ticks_to_burst = control->telemetry_every_ticks;
    self->telemetry_word = 0;
    self->sequence = 0;
    self->has_current = false;
    self->is_started = true;
}

static uint32_t handle_control(lockstep_can_t *self, const can_frame_t *frame, can_frame_t *out) {
    struct quiesce_can_lockstep_control_t control;
    (void)quiesce_can_lockstep_control_unpack(&control, frame->data, frame->length);
    if (control.telemetry_frames > QUIESCE_CAN_TELEMETRY_WORDS) {
        return reject(self);
    }
    switch (control.operation) {
    case QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_START_CHOICE:
        start(self, &control);
        break;
    case QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_STOP_CHOICE:
        self->is_started = false;
        self->is_stopped = true;
        break;
    case QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_STATUS_CHOICE:
        break;
    default:
        return reject(self);
    }
    put_status(self, out);
    return 1;
}

static uint32_t handle_param_write(lockstep_can_t *self, const can_frame_t *frame,
                                   can_frame_t *out) {
    struct quiesce_can_lockstep_param_write_t write;
    (void)quiesce_can_lockstep_param_write_unpack(&write, frame->data, frame->length);
    const bool is_stored = quiesce_param_set(&self->params, write.param_index, write.param_value);
    const struct quiesce_can_lockstep_param_ack_t ack = {
        .param_index = write.param_index,
        .param_value = is_stored ? write.param_value : 0,
        .is_stored = is_stored,
    };
    *out = (can_frame_t){
        .id = QUIESCE_CAN_LOCKSTEP_PARAM_ACK_FRAME_ID,
        .length = QUIESCE_CAN_LOCKSTEP_PARAM_ACK_LENGTH,
    };
    (void)quiesce_can_lockstep_param_ack_pack(out->data, &ack, sizeof out->data);
    return 1;
}

static uint32_t handle_current(lockstep_can_t *self, const can_frame_t *frame, can_frame_t *out) {
    struct quiesce_can_lockstep_current_t current;
    (void)out;
    (void)quiesce_can_lockstep_current_unpack(&current, frame->data, frame->length);
    if (!self->is_started) {
        return reject(self);
    }
    if (current.sequence != self->sequence) {
        count_up(&self->sequence_errors);
        return 0;
    }
    self->current_meas_mA = current.current_meas_mA;
    self->has_current = true;
    return 0;
}

static void run_tick(lockstep_can_t *self, const struct quiesce_can_lockstep_stimulus_t *wire) {
    const lockstep_stimulus_t stimulus = {
        .accel_counts = wire->accel_counts,
        .flags = (wire->accel_is_fresh ? LOCKSTEP_FRESH : 0u) |
                 (wire->enable ? LOCKSTEP_ENABLE : 0u) | (wire->estop ? LOCKSTEP_ESTOP : 0u) |
                 (wire->fault_reset ? LOCKSTEP_FAULT_RESET : 0u) |
                 (self->ticks_to_burst == 1u ? LOCKSTEP_REPORT : 0u) |
                 (self->has_current ? LOCKSTEP_HAS_CURRENT : 0u),
        .current_meas_mA = self->has_current ? self->current_meas_mA : 0,
    };
    self->has_current = false;
    self->sequence = (uint8_t)((self->sequence + 1u) % LOCKSTEP_CAN_SEQUENCE_PERIOD);
    lockstep_exchange(&self->server, &stimulus, &self->reply);
}

static void put_telemetry_word(lockstep_can_t *self, can_frame_t *out) {
    const uint32_t index = self->telemetry_word;
    uint32_t word;
    memcpy(&word,
           (const uint8_t *)&self->reply + offsetof(lockstep_reply_t, telemetry) + 4u * index,
           sizeof word);
    *out = (can_frame_t){.id = QUIESCE_CAN_TELEMETRY_FIRST_ID + index, .length = 4};
    for (uint32_t i = 0; i < 4u; i++) {
        out->data[i] = (uint8_t)(word >> (8u * i));
    }
    self->telemetry_word = (index + 1u) % QUIESCE_CAN_TELEMETRY_WORDS;
}

static uint32_t put_due_telemetry(lockstep_can_t *self, can_frame_t *out) {
    if (self->telemetry_every_ticks == 0u || --self->ticks_to_burst > 0u) {
        return 0;
    }
    self->ticks_to_burst = self->telemetry_every_ticks;
    for (uint32_t i = 0; i < self->telemetry_frames; i++) {
        put_telemetry_word(self, &out[i]);
    }
    return self->telemetry_frames;
}

static void put_command(const lockstep_can_t *self, uint8_t sequence, can_frame_t *out) {
    const quiesce_telemetry_t *telemetry = &self->reply.telemetry;
    const struct quiesce_can_lockstep_command_t command = {
        .current_cmd_mA = (uint16_t)self->reply.current_cmd_mA,
        .fault = (uint8_t)telemetry->fault,
        .state = (uint8_t)telemetry->state,
        .driver_is_enabled = self->reply.is_driver_enabled != 0u,
        .sequence = sequence,
    };
    *out = (can_frame_t){
        .id = QUIESCE_CAN_LOCKSTEP_COMMAND_FRAME_ID,
        .length = QUIESCE_CAN_LOCKSTEP_COMMAND_LENGTH,
    };
    (void)quiesce_can_lockstep_command_pack(out->data, &command, sizeof out->data);
}

static uint32_t handle_stimulus(lockstep_can_t *self, const can_frame_t *frame, can_frame_t *out) {
    struct quiesce_can_lockstep_stimulus_t wire;
    (void)quiesce_can_lockstep_stimulus_unpack(&wire, frame->data, frame->length);
    if (!self->is_started) {
        return reject(self);
    }
    if (wire.sequence != self->sequence) {
        count_up(&self->sequence_errors);
        return 0;
    }
    run_tick(self, &wire);
    const uint32_t count = put_due_telemetry(self, out);
    put_command(self, wire.sequence, &out[count]);
    return count + 1u;
}

typedef struct {
    uint32_t id;
    uint8_t length;
    uint32_t (*handle)(lockstep_can_t *self, const can_frame_t *frame, can_frame_t *out);
} handler_t;

static const handler_t handlers[] = {
    {QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID, QUIESCE_CAN_LOCKSTEP_STIMULUS_LENGTH, handle_stimulus},
    {QUIESCE_CAN_LOCKSTEP_CURRENT_FRAME_ID, QUIESCE_CAN_LOCKSTEP_CURRENT_LENGTH, handle_current},
    {QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID, QUIESCE_CAN_LOCKSTEP_CONTROL_LENGTH, handle_control},
    {QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_FRAME_ID, QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_LENGTH,
     handle_param_write},
};

void lockstep_can_init(lockstep_can_t *self) {
    memset(self, 0, sizeof *self);
    quiesce_params_default(&self->params);
}

void lockstep_can_greet(const lockstep_can_t *self, can_frame_t *out) {
    put_status(self, out);
}

uint32_t lockstep_can_receive(lockstep_can_t *self, const can_frame_t *frame,
                              can_frame_t out[LOCKSTEP_CAN_MAX_REPLIES]) {
    for (size_t i = 0; i < sizeof handlers / sizeof handlers[0]; i++) {
        if (frame->id == handlers[i].id && frame->length == handlers[i].length &&
            !frame->is_extended && !frame->is_remote) {
            return handlers[i].handle(self, frame, out);
        }
    }
    return reject(self);
}
