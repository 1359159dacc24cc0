#include "can_receive.h"

#include "fixq.h"
#include "quiesce_can.h"

// Of each sensor and each damper, one after the other: dbc.py holds their ids and layouts to that.
_Static_assert(QUIESCE_CAN_AT_ACCEL_SAMPLE + QUIESCE_MAX_SENSORS - 1 ==
                   QUIESCE_CAN_AT_SENSOR_SAMPLE7,
               "a message of each sensor");
_Static_assert(QUIESCE_CAN_AT_CURRENT_MEASURED + QUIESCE_MAX_DAMPERS - 1 ==
                   QUIESCE_CAN_AT_CURRENT_MEASURED3,
               "a message of each damper");

static void count(uint32_t *counter) {
    *counter = increment_sat_u32(*counter);
}

static uint32_t add_sat(uint32_t a, uint32_t b) {
    return a > UINT32_MAX - b ? UINT32_MAX : a + b;
}

static uint32_t timeout_ticks(uint32_t message, uint32_t tick_rate_Hz) {
    return (quiesce_can_messages[message].timeout_ms * tick_rate_Hz + 999u) / 1000u;
}

// Four periods of a slow sensor: its alive counter must not be forgotten between its samples.
static uint32_t sensor_timeout_ticks(uint32_t period_us, uint32_t tick_rate_Hz) {
    const uint32_t usual = timeout_ticks(QUIESCE_CAN_AT_ACCEL_SAMPLE, tick_rate_Hz);
    const uint32_t slow =
        (uint32_t)(((uint64_t)period_us * 4u * tick_rate_Hz + 999999u) / 1000000u);
    return slow > usual ? slow : usual;
}

void can_receive_use_rate(can_receive_t *self, uint32_t tick_rate_Hz) {
    self->stop.timeout_ticks = timeout_ticks(QUIESCE_CAN_AT_EMERGENCY_STOP, tick_rate_Hz);
    self->operator_command.timeout_ticks =
        timeout_ticks(QUIESCE_CAN_AT_OPERATOR_COMMAND, tick_rate_Hz);
    for (uint32_t i = 0; i < QUIESCE_SENSORS; i++) {
        self->sensor[i].from.timeout_ticks =
            sensor_timeout_ticks(self->sensor[i].period_us, tick_rate_Hz);
    }
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        self->driver[i].from.timeout_ticks =
            timeout_ticks(QUIESCE_CAN_AT_CURRENT_MEASURED, tick_rate_Hz);
    }
}

void can_receive_init(can_receive_t *self, uint32_t tick_rate_Hz) {
    *self = (can_receive_t){0};
    can_receive_use_rate(self, tick_rate_Hz);
}

static void count_refused(can_node_counters_t *counters, e2e_verdict_t verdict) {
    switch (verdict) {
    case E2E_WRONG_SHAPE:
        count(&counters->rejected_shape);
        break;
    case E2E_WRONG_CRC:
        count(&counters->rejected_crc);
        break;
    case E2E_REPEATED:
    case E2E_JUMPED:
        count(&counters->rejected_alive);
        break;
    case E2E_OK:
    default:
        break;
    }
}

static e2e_verdict_t judge(can_receive_t *self, e2e_receiver_t *receiver, uint32_t message,
                           const can_frame_t *frame) {
    const quiesce_can_message_t *row = &quiesce_can_messages[message];
    const e2e_verdict_t verdict = e2e_check(receiver, &row->e2e, row->max_lost, frame);
    count_refused(&self->counters, verdict);
    return verdict;
}

// Whether what the frame says may be used; its sender is heard even where not.
static bool is_good(can_receive_t *self, can_receiver_t *receiver, uint32_t message,
                    const can_frame_t *frame) {
    const e2e_verdict_t verdict = judge(self, &receiver->e2e, message, frame);
    if (verdict != E2E_WRONG_SHAPE && verdict != E2E_WRONG_CRC) {
        receiver->silent_ticks = 0;
    }
    return verdict == E2E_OK;
}

static void accept(can_receive_t *self, can_receiver_t *receiver) {
    count(&self->counters.accepted);
    receiver->age_ticks = 0;
    receiver->is_present = true;
}

static void take_stop(can_receive_t *self, const can_frame_t *frame) {
    struct quiesce_can_emergency_stop_t stop;
    if (!is_good(self, &self->stop, QUIESCE_CAN_AT_EMERGENCY_STOP, frame)) {
        return;
    }
    (void)quiesce_can_emergency_stop_unpack(&stop, frame->data, frame->length);
    if (stop.code != QUIESCE_CAN_EMERGENCY_STOP_CODE_STOP_CHOICE) {
        count(&self->counters.rejected_shape);
        return;
    }
    accept(self, &self->stop);
    self->is_stop_seen = true;
}

static void take_sample(can_receive_t *self, uint32_t number, const can_frame_t *frame) {
    struct quiesce_can_accel_sample_t sample;
    can_sensor_t *const sensor = &self->sensor[number];
    if (!is_good(self, &sensor->from, QUIESCE_CAN_AT_ACCEL_SAMPLE + number, frame)) {
        return;
    }
    (void)quiesce_can_accel_sample_unpack(&sample, frame->data, frame->length);
    accept(self, &sensor->from);
    if (sample.is_bad == 0u) {
        sensor->counts = sample.accel_counts;
        sensor->is_fresh = true;
    }
}

// A driver that is off, or waits for our demand, is well; a status that nobody knows is not.
static bool is_failure(uint32_t driver_status) {
    return driver_status != QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_OK_CHOICE &&
           driver_status != QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_OFF_CHOICE &&
           driver_status != QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_DEMAND_LOST_CHOICE;
}

static void take_current(can_receive_t *self, uint32_t number, const can_frame_t *frame) {
    struct quiesce_can_current_measured_t current;
    can_driver_t *const driver = &self->driver[number];
    if (!is_good(self, &driver->from, QUIESCE_CAN_AT_CURRENT_MEASURED + number, frame)) {
        return;
    }
    (void)quiesce_can_current_measured_unpack(&current, frame->data, frame->length);
    accept(self, &driver->from);
    driver->current_mA = current.current_meas_mA;
    driver->has_failed = is_failure(current.driver_status);
}

static void take_operator(can_receive_t *self, const can_frame_t *frame) {
    struct quiesce_can_operator_command_t command;
    if (!is_good(self, &self->operator_command, QUIESCE_CAN_AT_OPERATOR_COMMAND, frame)) {
        return;
    }
    (void)quiesce_can_operator_command_unpack(&command, frame->data, frame->length);
    accept(self, &self->operator_command);
    self->enable = command.enable != 0u;
    self->is_reset_edge = self->is_reset_edge || (command.fault_reset != 0u && self->is_released);
    self->is_released = command.fault_reset == 0u;
}

// Of a sensor or a damper that the build has: messages of others are none of the controller's.
static bool is_taken_by_number(can_receive_t *self, const can_frame_t *frame) {
    const uint32_t sensor = frame->id - QUIESCE_CAN_ACCEL_SAMPLE_FRAME_ID; // wraps below the first
    const uint32_t damper = frame->id - QUIESCE_CAN_CURRENT_MEASURED_FRAME_ID;
    if (sensor < QUIESCE_SENSORS) {
        take_sample(self, sensor, frame);
    } else if (damper < QUIESCE_DAMPERS) {
        take_current(self, damper, frame);
    } else {
        return false;
    }
    return true;
}

bool can_receive_frame(can_receive_t *self, const can_frame_t *frame) {
    if (is_taken_by_number(self, frame)) {
        return false;
    }
    switch (frame->id) {
    case QUIESCE_CAN_EMERGENCY_STOP_FRAME_ID:
        take_stop(self, frame);
        return false;
    case QUIESCE_CAN_OPERATOR_COMMAND_FRAME_ID:
        take_operator(self, frame);
        return false;
    case QUIESCE_CAN_SERVICE_REQUEST_FRAME_ID:
        if (judge(self, &self->service, QUIESCE_CAN_AT_SERVICE_REQUEST, frame) != E2E_OK) {
            return false;
        }
        count(&self->counters.accepted);
        return true;
    default:
        count(&self->counters.unknown);
        return false;
    }
}

static void age(can_receiver_t *self, uint32_t ticks) {
    self->age_ticks = add_sat(self->age_ticks, ticks);
    self->silent_ticks = add_sat(self->silent_ticks, ticks);
    self->is_present = self->is_present && self->age_ticks <= self->timeout_ticks;
    if (self->silent_ticks > self->timeout_ticks) {
        e2e_forget(&self->e2e);
    }
}

static quiesce_sample_t hand_over_sample(can_sensor_t *self, uint32_t ticks) {
    age(&self->from, ticks);
    const bool is_fresh = self->is_fresh && self->from.is_present;
    self->is_fresh = false;
    return (quiesce_sample_t){.counts = is_fresh ? self->counts : 0, .is_fresh = is_fresh};
}

static quiesce_driver_t hand_over_driver(can_driver_t *self, uint32_t ticks) {
    age(&self->from, ticks);
    const bool is_measured = self->from.is_present;
    return (quiesce_driver_t){
        .current_mA = is_measured ? self->current_mA : 0,
        .is_measured = is_measured,
        .has_failed = is_measured && self->has_failed,
    };
}

void can_receive_inputs(can_receive_t *self, uint32_t ticks, can_node_inputs_t *inputs) {
    age(&self->stop, ticks);
    age(&self->operator_command, ticks);

    const bool is_operated = self->operator_command.is_present;
    *inputs = (can_node_inputs_t){
        .enable = is_operated && self->enable,
        .fault_reset = is_operated && self->is_reset_edge,
        .estop = self->stop.is_present || self->is_stop_seen,
    };
    for (uint32_t i = 0; i < QUIESCE_SENSORS; i++) {
        inputs->sensor[i] = hand_over_sample(&self->sensor[i], ticks);
    }
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        inputs->driver[i] = hand_over_driver(&self->driver[i], ticks);
    }
    self->is_stop_seen = false;
    self->is_reset_edge = false;
    self->is_released = self->is_released && is_operated;
}
