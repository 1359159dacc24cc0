#include "can_freeze.h"

#include "quiesce_can.h"
#include "quiesce_can_tables.h"

#define REPEAT_MS 1000u
#define NUMBERS 16u

void can_freeze_restart(can_freeze_t *self, int32_t safe_current_mA) {
    self->state = QUIESCE_STATE_INIT;
    self->fault = QUIESCE_FAULT_NONE;
    self->fault_count = 0;
    self->current_cmd_mA = safe_current_mA;
    self->current_law_mA = 0;
}

void can_freeze_init(can_freeze_t *self, int32_t safe_current_mA) {
    *self = (can_freeze_t){.next_page = CAN_FREEZE_PAGES};
    can_freeze_restart(self, safe_current_mA);
}

static void capture(can_freeze_t *self, const can_freeze_tick_t *tick) {
    const quiesce_telemetry_t *t = &tick->out->telemetry;
    self->held = (can_freeze_words_t){
        .tick = t->tick,
        .fault = t->fault,
        .state = self->state,
        .current_cmd_mA = self->current_cmd_mA,
        .current_law_mA = self->current_law_mA,
        .accel_counts = tick->accel_counts,
        .accel_um_s2 = t->accel_um_s2,
        .rms_um_s2 = t->rms_um_s2,
        .freq_uHz = t->freq_uHz,
        .current_meas_mA = tick->current_is_measured ? tick->current_meas_mA : 0,
        .displacement_amp_nm = t->displacement_amp_nm,
        .freq_is_valid = t->freq_is_valid != 0u,
        .current_is_measured = tick->current_is_measured,
    };
    self->is_held = true;
    self->number = (uint8_t)((self->number + 1u) % NUMBERS);
}

static void send_again(can_freeze_t *self) {
    self->next_page = 0;
    self->repeat_ms = 0;
}

bool can_freeze_request(can_freeze_t *self) {
    if (self->is_held) {
        send_again(self);
    }
    return self->is_held;
}

static void remember(can_freeze_t *self, const quiesce_out_t *out) {
    self->state = out->telemetry.state;
    self->fault = out->telemetry.fault;
    self->fault_count = out->telemetry.fault_count;
    self->current_cmd_mA = out->damper[0].current_cmd_mA;
    self->current_law_mA = out->telemetry.current_law_mA;
}

void can_freeze_watch(can_freeze_t *self, uint32_t passed_ms, const can_freeze_tick_t *tick) {
    const quiesce_telemetry_t *t = &tick->out->telemetry;
    const bool is_faulted = t->fault != QUIESCE_FAULT_NONE;
    self->repeat_ms += passed_ms;
    if (is_faulted && (t->fault != self->fault || t->fault_count != self->fault_count)) {
        capture(self, tick);
        send_again(self);
    } else if (!is_faulted) {
        self->repeat_ms = 0;
    } else if (self->repeat_ms >= REPEAT_MS) {
        send_again(self);
    }
    remember(self, tick->out);
}

// Signals of the other pages are 0 and stay unpacked.
static struct quiesce_can_fault_freeze_t pages_of(const can_freeze_t *self) {
    const can_freeze_words_t *w = &self->held;
    return (struct quiesce_can_fault_freeze_t){
        .page = self->next_page,
        .freeze_number = self->number,
        .freeze_fault = quiesce_can_fault_freeze_freeze_fault_sat(w->fault),
        .freeze_state = quiesce_can_fault_freeze_freeze_state_sat(w->state),
        .freeze_tick = w->tick,
        .freeze_accel_counts = quiesce_can_fault_freeze_freeze_accel_counts_sat(w->accel_counts),
        .freeze_accel_um_s2 = w->accel_um_s2,
        .freeze_freq_is_valid = w->freq_is_valid,
        .freeze_rms_um_s2 = w->rms_um_s2,
        .freeze_freq_uHz = w->freq_uHz,
        .freeze_current_is_measured = w->current_is_measured,
        .freeze_current_cmd_mA =
            quiesce_can_fault_freeze_freeze_current_cmd_mA_sat(w->current_cmd_mA),
        .freeze_current_meas_mA =
            quiesce_can_fault_freeze_freeze_current_meas_mA_sat(w->current_meas_mA),
        .freeze_current_law_mA =
            quiesce_can_fault_freeze_freeze_current_law_mA_sat(w->current_law_mA),
        .freeze_displacement_amp_nm = w->displacement_amp_nm,
    };
}

bool can_freeze_page(can_freeze_t *self, can_frame_t *frame) {
    if (self->next_page >= CAN_FREEZE_PAGES) {
        return false;
    }
    const struct quiesce_can_fault_freeze_t page = pages_of(self);
    (void)quiesce_can_fault_freeze_pack(frame->data, &page, sizeof frame->data);
    self->next_page++;
    return true;
}
