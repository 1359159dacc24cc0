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

static int32_t time_us(uint32_t time_ms) {
    return (int32_t)(time_ms * 1000u);
}

static int32_t most(int32_t a, int32_t b) {
    return a > b ? a : b;
}

// No message comes more often than once a tick.
static void use_cycle(const can_receive_t *self, freshness_t *from, uint32_t message) {
    const quiesce_can_message_t *row = &quiesce_can_messages[message];
    freshness_use(from, most(time_us(row->cycle_ms), self->tick_us), time_us(row->timeout_ms));
}

// A slow sensor has the board's period, and four of them as its timeout.
static void use_sensor_cycle(const can_receive_t *self, can_sensor_t *sensor, uint32_t message) {
    if (sensor->period_us == 0u) {
        use_cycle(self, &sensor->from, message);
        return;
    }
    const int32_t period_us = most((int32_t)sensor->period_us, self->tick_us);
    const int32_t usual_us = time_us(quiesce_can_messages[message].timeout_ms);
    freshness_use(&sensor->from, period_us, most(usual_us, 4 * period_us));
}

void can_receive_use_rate(can_receive_t *self, uint32_t tick_rate_Hz) {
    const uint32_t stop_ms = quiesce_can_messages[QUIESCE_CAN_AT_EMERGENCY_STOP].timeout_ms;
    self->tick_us = (int32_t)(1000000u / tick_rate_Hz);
    self->calm_ticks = CAN_SENSOR_CALM_MS * tick_rate_Hz / 1000u;
    self->stop.timeout_ticks = (stop_ms * tick_rate_Hz + 999u) / 1000u;
    use_cycle(self, &self->operator_command.from, QUIESCE_CAN_AT_OPERATOR_COMMAND);
    for (uint32_t i = 0; i < QUIESCE_SENSORS; i++) {
        use_sensor_cycle(self, &self->sensor[i], QUIESCE_CAN_AT_ACCEL_SAMPLE + i);
    }
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        use_cycle(self, &self->driver[i].from, QUIESCE_CAN_AT_CURRENT_MEASURED + i);
    }
}

void can_receive_init(can_receive_t *self, uint32_t tick_rate_Hz) {
    *self = (can_receive_t){0};
    can_receive_use_rate(self, tick_rate_Hz);
}

static bool is_whole(can_receive_t *self, uint32_t message, const can_frame_t *frame) {
    const e2e_verdict_t verdict = e2e_check(&quiesce_can_messages[message].e2e, frame);
    if (verdict == E2E_WRONG_SHAPE) {
        count(&self->counters.rejected_shape);
    } else if (verdict == E2E_WRONG_CRC) {
        count(&self->counters.rejected_crc);
    }
    return verdict == E2E_OK;
}

// All that a message of up to 5 bytes says, whose last byte is the CRC.
static uint32_t content(const can_frame_t *frame) {
    uint32_t word = 0;
    for (uint32_t i = 0; i < 4u && i < frame->length; i++) {
        word |= (uint32_t)frame->data[i] << 8u * i;
    }
    return word;
}

static freshness_verdict_t judge(can_receive_t *self, freshness_t *from, uint32_t message,
                                 const can_frame_t *frame) {
    const e2e_layout_t *layout = &quiesce_can_messages[message].e2e;
    const freshness_verdict_t verdict =
        freshness_judge(from, e2e_alive(layout, frame), content(frame));
    if (verdict == FRESHNESS_COUNTS) {
        count(&self->counters.accepted);
    } else if (verdict == FRESHNESS_REFUSED) {
        count(&self->counters.rejected_alive);
    }
    return verdict;
}

static void take_stop(can_receive_t *self, const can_frame_t *frame) {
    struct quiesce_can_emergency_stop_t stop;
    if (!is_whole(self, QUIESCE_CAN_AT_EMERGENCY_STOP, frame)) {
        return;
    }
    (void)quiesce_can_emergency_stop_unpack(&stop, frame->data, frame->length);
    if (stop.code != QUIESCE_CAN_EMERGENCY_STOP_CODE_STOP_CHOICE) {
        count(&self->counters.rejected_shape);
        return;
    }
    count(&self->counters.accepted);
    self->stop.age_ticks = 0;
    self->stop.is_present = true;
    self->stop.is_seen = true;
}

static void pass_over_oldest(can_sensor_t *self) {
    self->waiting[0] = self->waiting[1];
    self->count--;
}

// may_wait: the sensor has a sample a tick. Where there is no room the newest ones count.
static void put_sample(can_sensor_t *self, bool may_wait, quiesce_sample_t sample) {
    if (self->count == (may_wait ? 2u : 1u)) {
        pass_over_oldest(self);
    }
    self->waiting[self->count++] = sample;
    self->come = self->come == 0u ? 1u : 2u;
}

static void take_sample(can_receive_t *self, uint32_t number, const can_frame_t *frame) {
    struct quiesce_can_accel_sample_t sample;
    can_sensor_t *const sensor = &self->sensor[number];
    const uint32_t message = QUIESCE_CAN_AT_ACCEL_SAMPLE + number;
    if (!is_whole(self, message, frame) ||
        judge(self, &sensor->from, message, frame) != FRESHNESS_COUNTS) {
        return;
    }
    (void)quiesce_can_accel_sample_unpack(&sample, frame->data, frame->length);
    if (sample.is_bad == 0u) {
        put_sample(sensor, sensor->from.cycle_us == self->tick_us,
                   (quiesce_sample_t){.counts = sample.accel_counts,
                                      .is_fresh = true,
                                      .is_saturated = sample.is_saturated != 0u});
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
    const uint32_t message = QUIESCE_CAN_AT_CURRENT_MEASURED + number;
    if (!is_whole(self, message, frame)) {
        return;
    }
    (void)quiesce_can_current_measured_unpack(&current, frame->data, frame->length);
    const bool has_failed = is_failure(current.driver_status);
    driver->failure_is_seen = driver->failure_is_seen || has_failed;
    if (judge(self, &driver->from, message, frame) == FRESHNESS_COUNTS) {
        driver->current_mA = current.current_meas_mA;
        driver->has_failed = has_failed;
        driver->is_new = true;
    }
}

static can_press_t next_press(can_press_t press, bool fault_reset) {
    if (!fault_reset) {
        const bool was_released = press == CAN_PRESS_RELEASED_ONCE || press == CAN_PRESS_RELEASED;
        return was_released ? CAN_PRESS_RELEASED : CAN_PRESS_RELEASED_ONCE;
    }
    return press == CAN_PRESS_RELEASED ? CAN_PRESS_ONCE
           : press == CAN_PRESS_ONCE   ? CAN_PRESS_TWICE
                                       : CAN_PRESS_NONE;
}

// Of a sender that is not known a press means nothing, nor what was said before its row: who comes
// back pressing has to be seen let go.
static void hear_stranger(can_operator_t *panel, freshness_verdict_t verdict, bool enable,
                          bool had_let_go) {
    if (!freshness_is_known(&panel->from)) {
        panel->was_enabled = enable && verdict == FRESHNESS_ON_TRIAL;
        panel->was_let_go = verdict == FRESHNESS_BEGINS
                                ? !enable
                                : verdict == FRESHNESS_ON_TRIAL && (had_let_go || !enable);
        panel->press = CAN_PRESS_NONE;
    }
}

static void take_operator(can_receive_t *self, const can_frame_t *frame) {
    struct quiesce_can_operator_command_t command;
    can_operator_t *const panel = &self->operator_command;
    if (!is_whole(self, QUIESCE_CAN_AT_OPERATOR_COMMAND, frame)) {
        return;
    }
    (void)quiesce_can_operator_command_unpack(&command, frame->data, frame->length);
    const bool enable = command.enable != 0u;
    panel->enable = panel->enable && enable;
    panel->was_enabled = panel->was_enabled && enable;
    const bool had_let_go = panel->was_let_go;
    panel->was_let_go = had_let_go && enable; // a stop that does not count: to be let go for real
    const freshness_verdict_t verdict =
        judge(self, &panel->from, QUIESCE_CAN_AT_OPERATOR_COMMAND, frame);
    if (verdict != FRESHNESS_COUNTS) {
        hear_stranger(panel, verdict, enable, had_let_go);
        return;
    }
    panel->enable = panel->was_enabled && panel->was_let_go;
    panel->was_enabled = enable;
    panel->was_let_go = had_let_go || !enable;
    panel->is_reset_edge = panel->is_reset_edge || panel->press == CAN_PRESS_TWICE;
    panel->press = next_press(panel->press, command.fault_reset != 0u);
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
        if (!is_whole(self, QUIESCE_CAN_AT_SERVICE_REQUEST, frame)) {
            return false;
        }
        count(&self->counters.accepted);
        return true;
    default:
        count(&self->counters.unknown);
        return false;
    }
}

static void age_stop(can_stop_t *self, uint32_t ticks) {
    self->age_ticks = add_sat(self->age_ticks, ticks);
    self->is_present = self->is_present && self->age_ticks <= self->timeout_ticks;
}

static int32_t ticks_us(const can_receive_t *self, uint32_t ticks) {
    const uint32_t most_ticks = (uint32_t)(INT32_MAX / self->tick_us);
    return (int32_t)(ticks < most_ticks ? ticks : most_ticks) * self->tick_us;
}

static void count_calm(can_sensor_t *self, uint32_t calm_ticks) {
    const bool is_calm = self->come == 1u && self->calm_ticks < calm_ticks;
    self->calm_ticks = is_calm ? (uint16_t)(self->calm_ticks + 1u) : 0u;
    self->come = 0;
}

static quiesce_sample_t hand_over_sample(can_receive_t *self, uint32_t number, uint32_t ticks) {
    can_sensor_t *const sensor = &self->sensor[number];
    freshness_pass(&sensor->from, ticks_us(self, ticks));
    count_calm(sensor, self->calm_ticks);
    // Of two that wait the older one is passed over where ticks were lost, and in a calm.
    if (sensor->count == 2u && (ticks > 1u || sensor->calm_ticks == self->calm_ticks)) {
        pass_over_oldest(sensor);
    }
    if (!freshness_is_known(&sensor->from)) {
        sensor->count = 0;
    }
    if (sensor->count == 0u) {
        return (quiesce_sample_t){0};
    }
    const quiesce_sample_t sample = sensor->waiting[0];
    pass_over_oldest(sensor);
    return sample;
}

static quiesce_driver_t hand_over_driver(can_driver_t *self, int32_t passed_us) {
    freshness_pass(&self->from, passed_us);
    const bool is_measured = freshness_is_known(&self->from);
    const bool has_failed = self->failure_is_seen || (is_measured && self->has_failed);
    const bool is_old = is_measured && !self->is_new;
    self->failure_is_seen = false;
    self->is_new = false;
    return (quiesce_driver_t){
        .current_mA = is_measured ? self->current_mA : 0,
        .is_measured = is_measured,
        .is_old = is_old,
        .has_failed = has_failed,
    };
}

void can_receive_inputs(can_receive_t *self, uint32_t ticks, can_node_inputs_t *inputs) {
    const int32_t passed_us = ticks_us(self, ticks);
    age_stop(&self->stop, ticks);
    freshness_pass(&self->operator_command.from, passed_us);

    const bool is_operated = freshness_is_known(&self->operator_command.from);
    *inputs = (can_node_inputs_t){
        .enable = is_operated && self->operator_command.enable,
        .fault_reset = is_operated && self->operator_command.is_reset_edge,
        .estop = self->stop.is_present || self->stop.is_seen,
    };
    for (uint32_t i = 0; i < QUIESCE_SENSORS; i++) {
        inputs->sensor[i] = hand_over_sample(self, i, ticks);
    }
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        inputs->driver[i] = hand_over_driver(&self->driver[i], passed_us);
    }
    self->stop.is_seen = false;
    self->operator_command.is_reset_edge = false;
}
