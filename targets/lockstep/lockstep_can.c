#include "lockstep_can.h"

#include <stddef.h>
#include <string.h>

_Static_assert(offsetof(lockstep_reply_t, picture) - offsetof(lockstep_reply_t, telemetry) ==
                   4u * QUIESCE_CAN_TELEMETRY_WORDS,
               "quiesce.dbc has one telemetry message a word");
_Static_assert(QUIESCE_PARAM_COUNT <= UINT8_MAX, "indices fit LockstepStatus");
_Static_assert(QUIESCE_TABLE_WORDS <= LOCKSTEP_CAN_TABLE_COUNT, "words have indices of their own");

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
        .board_is_refused = self->board_is_refused,
        .table_verdict = (uint8_t)self->server.refused.verdict,
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

// What the last start of the server refused: one thing at the most.
static void note_refusal(lockstep_can_t *self, bool is_accepted) {
    const lockstep_refusal_t *table = &self->server.refused;
    const bool table_is_refused = table->verdict != QUIESCE_TABLE_OK;
    quiesce_param_error_t error = {0};
    self->param_is_refused = !quiesce_params_check(&self->params, &error);
    self->board_is_refused = !is_accepted && !self->param_is_refused && !table_is_refused;
    self->refused_index = (uint8_t)(table_is_refused ? table->table : error.index);
}

static bool start_server(lockstep_can_t *self, const quiesce_board_t *board) {
    lockstep_table_t tables[LOCKSTEP_TABLES];
    for (uint32_t i = 0; i < LOCKSTEP_TABLES; i++) {
        tables[i] = (lockstep_table_t){self->table[i], self->table_words[i]};
    }
    const bool is_accepted = lockstep_start(&self->server, board, &self->params, tables);
    note_refusal(self, is_accepted);
    return is_accepted;
}

static void start(lockstep_can_t *self, const struct quiesce_can_lockstep_control_t *control) {
    const bool has_board =
        control->operation == QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_START_BOARD_CHOICE;
    const bool is_accepted = start_server(self, has_board ? &self->board : NULL);
    self->dampers = has_board && is_accepted ? (uint32_t)self->board.dampers : 1u;
    self->telemetry_every_ticks = control->telemetry_every_ticks;
    self->telemetry_frames = control->telemetry_frames;
    self->ticks_to_burst = control->telemetry_every_ticks;
    self->telemetry_word = 0;
    self->sequence = 0;
    self->pending = (lockstep_stimulus_t){0};
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
    case QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_START_BOARD_CHOICE:
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

static bool store_board_word(lockstep_can_t *self, uint32_t word, int32_t value) {
    if (word >= LOCKSTEP_CAN_BOARD_WORDS) {
        return false;
    }
    memcpy((uint8_t *)&self->board + sizeof value * word, &value, sizeof value);
    return true;
}

// Ends the run, whose controller may have the table in use.
static bool store_table_word(lockstep_can_t *self, uint32_t table, uint32_t word, int32_t value) {
    if (table >= LOCKSTEP_TABLES ||
        (word >= QUIESCE_TABLE_WORDS && word != LOCKSTEP_CAN_TABLE_COUNT)) {
        return false;
    }
    self->is_started = false;
    if (word == LOCKSTEP_CAN_TABLE_COUNT) {
        self->table_words[table] = (uint32_t)value;
    } else {
        self->table[table][word] = (uint32_t)value;
    }
    return true;
}

// A parameter, a word of the board or of a table.
static bool store(lockstep_can_t *self, uint32_t index, int32_t value) {
    if (index < LOCKSTEP_CAN_BOARD_INDEX) {
        return quiesce_param_set(&self->params, index, value);
    }
    if (index < LOCKSTEP_CAN_TABLE_INDEX) {
        return store_board_word(self, index - LOCKSTEP_CAN_BOARD_INDEX, value);
    }
    const uint32_t word = index - LOCKSTEP_CAN_TABLE_INDEX;
    return store_table_word(self, word / LOCKSTEP_CAN_TABLE_INDICES,
                            word % LOCKSTEP_CAN_TABLE_INDICES, value);
}

static uint32_t handle_param_write(lockstep_can_t *self, const can_frame_t *frame,
                                   can_frame_t *out) {
    struct quiesce_can_lockstep_param_write_t write;
    (void)quiesce_can_lockstep_param_write_unpack(&write, frame->data, frame->length);
    const bool is_stored = store(self, write.param_index, write.param_value);
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

// Whether what comes before a stimulus is for the next one.
static bool is_next(lockstep_can_t *self, uint8_t sequence) {
    if (!self->is_started) {
        (void)reject(self);
        return false;
    }
    if (sequence != self->sequence) {
        count_up(&self->sequence_errors);
        return false;
    }
    return true;
}

static uint32_t handle_current(lockstep_can_t *self, const can_frame_t *frame, can_frame_t *out) {
    struct quiesce_can_lockstep_current_t current;
    (void)out;
    (void)quiesce_can_lockstep_current_unpack(&current, frame->data, frame->length);
    if (is_next(self, current.sequence)) {
        self->pending.current_meas_mA[current.damper_number] = current.current_meas_mA;
        self->pending.flags |= LOCKSTEP_HAS_CURRENT << current.damper_number;
    }
    return 0;
}

static uint32_t handle_sensor(lockstep_can_t *self, const can_frame_t *frame, can_frame_t *out) {
    struct quiesce_can_lockstep_sensor_t sensor;
    (void)out;
    (void)quiesce_can_lockstep_sensor_unpack(&sensor, frame->data, frame->length);
    if (sensor.sensor_number == 0) { // its sample is in the stimulus
        return reject(self);
    }
    if (is_next(self, sensor.sequence)) {
        self->pending.counts[sensor.sensor_number] = sensor.sample_counts;
        self->pending.flags |= LOCKSTEP_FRESH << sensor.sensor_number;
    }
    return 0;
}

static void run_tick(lockstep_can_t *self, const struct quiesce_can_lockstep_stimulus_t *wire) {
    lockstep_stimulus_t stimulus = self->pending;
    stimulus.counts[0] = wire->accel_counts;
    stimulus.flags |= (wire->accel_is_fresh ? LOCKSTEP_FRESH : 0u) |
                      (wire->enable ? LOCKSTEP_ENABLE : 0u) | (wire->estop ? LOCKSTEP_ESTOP : 0u) |
                      (wire->fault_reset ? LOCKSTEP_FAULT_RESET : 0u) |
                      (self->ticks_to_burst == 1u ? LOCKSTEP_REPORT : 0u);
    self->pending = (lockstep_stimulus_t){0};
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

static bool is_enabled(const lockstep_can_t *self, uint32_t damper) {
    return (self->reply.drivers_enabled >> damper & 1u) != 0;
}

static void put_damper(const lockstep_can_t *self, uint32_t damper, uint8_t sequence,
                       can_frame_t *out) {
    const struct quiesce_can_lockstep_damper_t command = {
        .current_cmd_mA = (uint16_t)self->reply.current_cmd_mA[damper],
        .damper_number = (uint8_t)damper,
        .driver_is_enabled = is_enabled(self, damper),
        .sequence = sequence,
    };
    *out = (can_frame_t){
        .id = QUIESCE_CAN_LOCKSTEP_DAMPER_FRAME_ID,
        .length = QUIESCE_CAN_LOCKSTEP_DAMPER_LENGTH,
    };
    (void)quiesce_can_lockstep_damper_pack(out->data, &command, sizeof out->data);
}

static void put_command(const lockstep_can_t *self, uint8_t sequence, can_frame_t *out) {
    const quiesce_telemetry_t *telemetry = &self->reply.telemetry;
    const struct quiesce_can_lockstep_command_t command = {
        .current_cmd_mA = (uint16_t)self->reply.current_cmd_mA[0],
        .fault = (uint8_t)telemetry->fault,
        .state = (uint8_t)telemetry->state,
        .driver_is_enabled = is_enabled(self, 0),
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
    if (!is_next(self, wire.sequence)) {
        return 0;
    }
    run_tick(self, &wire);
    uint32_t count = put_due_telemetry(self, out);
    for (uint32_t i = 1; i < self->dampers; i++) {
        put_damper(self, i, wire.sequence, &out[count++]);
    }
    put_command(self, wire.sequence, &out[count++]);
    return count;
}

typedef struct {
    uint32_t id;
    uint8_t length;
    uint32_t (*handle)(lockstep_can_t *self, const can_frame_t *frame, can_frame_t *out);
} handler_t;

static const handler_t handlers[] = {
    {QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID, QUIESCE_CAN_LOCKSTEP_STIMULUS_LENGTH, handle_stimulus},
    {QUIESCE_CAN_LOCKSTEP_CURRENT_FRAME_ID, QUIESCE_CAN_LOCKSTEP_CURRENT_LENGTH, handle_current},
    {QUIESCE_CAN_LOCKSTEP_SENSOR_FRAME_ID, QUIESCE_CAN_LOCKSTEP_SENSOR_LENGTH, handle_sensor},
    {QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID, QUIESCE_CAN_LOCKSTEP_CONTROL_LENGTH, handle_control},
    {QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_FRAME_ID, QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_LENGTH,
     handle_param_write},
};

void lockstep_can_init(lockstep_can_t *self) {
    memset(self, 0, sizeof *self);
    quiesce_params_default(&self->params);
    quiesce_board_default(&self->board);
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
