#include "can_pack.h"

#include "quiesce_can.h"
#include "quiesce_can_tables.h"
#include "quiesce_version.h"

void can_pack_demand(uint32_t state, int32_t current_mA, bool is_enabled, can_frame_t *frame) {
    const struct quiesce_can_current_demand_t wire = {
        .current_cmd_mA = quiesce_can_current_demand_current_cmd_mA_sat(current_mA),
        .driver_is_enabled = is_enabled,
        .state = quiesce_can_current_demand_state_sat(state),
    };
    (void)quiesce_can_current_demand_pack(frame->data, &wire, sizeof frame->data);
}

void can_pack_status(const can_node_tick_t *tick, const quiesce_telemetry_t *t, bool is_streaming,
                     can_frame_t *frame) {
    const struct quiesce_can_status_t wire = {
        .state = quiesce_can_status_state_sat(t->state),
        .freq_is_valid = t->freq_is_valid != 0u,
        .lock_is_on = t->lock_is_on != 0u,
        .is_enabled = tick->enable,
        .is_estop = tick->estop,
        .raw_is_streaming = is_streaming,
        .fault = quiesce_can_status_fault_sat(t->fault),
        .rms_um_s2 = quiesce_can_status_rms_um_s2_sat(t->rms_um_s2),
        .fault_count = quiesce_can_status_fault_count_sat(t->fault_count),
    };
    (void)quiesce_can_status_pack(frame->data, &wire, sizeof frame->data);
}

void can_pack_motion(const quiesce_telemetry_t *t, can_frame_t *frame) {
    const struct quiesce_can_motion_t wire = {
        .freq_uHz = t->freq_uHz,
        .displacement_amp_nm = t->displacement_amp_nm,
    };
    (void)quiesce_can_motion_pack(frame->data, &wire, sizeof frame->data);
}

void can_pack_peak(const quiesce_telemetry_t *t, uint32_t peak, can_frame_t *frame) {
    const struct quiesce_can_spectrum_peak0_t wire = {
        .peak0_freq_uHz = t->peaks[peak].freq_uHz,
        .peak0_amp_um_s2 = t->peaks[peak].amp_um_s2,
    };
    (void)quiesce_can_spectrum_peak0_pack(frame->data, &wire, sizeof frame->data);
}

void can_pack_law(int32_t law, const quiesce_telemetry_t *t, uint32_t report_number,
                  int32_t report_word, can_frame_t *frame) {
    const struct quiesce_can_law_state_t wire = {
        .law = quiesce_can_law_state_law_sat(law),
        .report_number = quiesce_can_law_state_report_number_sat(report_number),
        .report_word = report_word,
        .current_law_mA = quiesce_can_law_state_current_law_mA_sat(t->current_law_mA),
    };
    (void)quiesce_can_law_state_pack(frame->data, &wire, sizeof frame->data);
}

void can_pack_timing(uint32_t overruns, uint32_t lateness_max_us, uint32_t work_max_us,
                     can_frame_t *frame) {
    const struct quiesce_can_loop_timing_t wire = {
        .overruns = quiesce_can_loop_timing_overruns_sat(overruns),
        .lateness_max_us = quiesce_can_loop_timing_lateness_max_us_sat(lateness_max_us),
        .work_max_us = quiesce_can_loop_timing_work_max_us_sat(work_max_us),
    };
    (void)quiesce_can_loop_timing_pack(frame->data, &wire, sizeof frame->data);
}

void can_pack_cycles(const can_cycles_t *most, can_frame_t *frame) {
    const struct quiesce_can_loop_cycles_t wire = {
        .work_max_cycles = quiesce_can_loop_cycles_work_max_cycles_sat(most->work),
        .interrupt_max_cycles = quiesce_can_loop_cycles_interrupt_max_cycles_sat(most->interrupt),
        .core_kHz = quiesce_can_loop_cycles_core_kHz_sat(most->core_kHz),
    };
    (void)quiesce_can_loop_cycles_pack(frame->data, &wire, sizeof frame->data);
}

void can_pack_health(const can_node_counters_t *counters, const can_node_tick_t *tick,
                     can_frame_t *frame) {
    const uint32_t shape = counters->rejected_shape;
    const uint32_t unread = shape > UINT32_MAX - tick->rx_lost ? UINT32_MAX : shape + tick->rx_lost;
    const struct quiesce_can_can_health_t wire = {
        .rejected_crc = quiesce_can_can_health_rejected_crc_sat(counters->rejected_crc),
        .rejected_alive = quiesce_can_can_health_rejected_alive_sat(counters->rejected_alive),
        .rejected_shape = quiesce_can_can_health_rejected_shape_sat(unread),
        .bus_off_count = quiesce_can_can_health_bus_off_count_sat(tick->bus_off_count),
    };
    (void)quiesce_can_can_health_pack(frame->data, &wire, sizeof frame->data);
}

void can_unsent_count(can_unsent_t *unsent, uint32_t id) {
    if (id <= QUIESCE_CAN_STATUS_FRAME_ID) {
        unsent->demands++;
    } else if (id == QUIESCE_CAN_SERVICE_REPLY_FRAME_ID ||
               id == QUIESCE_CAN_FAULT_FREEZE_FRAME_ID || id == QUIESCE_CAN_TABLE_FLOW_FRAME_ID) {
        unsent->answers++;
    } else {
        unsent->telemetry++;
    }
}

// Each wraps: a counter that stands at its end says nothing any more.
void can_pack_shed(const can_unsent_t *unsent, can_frame_t *frame) {
    const struct quiesce_can_can_shed_t wire = {
        .unsent_demands = (uint16_t)(unsent->demands & UINT16_MAX),
        .unsent_answers = (uint16_t)(unsent->answers & UINT16_MAX),
        .unsent_telemetry = unsent->telemetry,
    };
    (void)quiesce_can_can_shed_pack(frame->data, &wire, sizeof frame->data);
}

void can_pack_identification(uint32_t param_hash, can_frame_t *frame) {
    const struct quiesce_can_identification_t wire = {
        .version_major = QUIESCE_VERSION_MAJOR,
        .version_minor = QUIESCE_VERSION_MINOR,
        .version_patch = QUIESCE_VERSION_PATCH,
        .interface_version = QUIESCE_CAN_INTERFACE_VERSION,
        .param_hash = param_hash,
    };
    (void)quiesce_can_identification_pack(frame->data, &wire, sizeof frame->data);
}

void can_pack_raw(const can_node_tick_t *tick, uint32_t number, can_frame_t *frame) {
    const struct quiesce_can_raw_sample_t wire = {
        .tick_low = (uint16_t)(number & UINT16_MAX), // wraps: its lowest bits are meant
        .accel_counts = quiesce_can_raw_sample_accel_counts_sat(tick->accel_counts),
        .accel_is_fresh = tick->accel_is_fresh,
        .current_is_measured = tick->current_is_measured,
        .current_meas_mA = quiesce_can_raw_sample_current_meas_mA_sat(
            tick->current_is_measured ? tick->current_meas_mA : 0),
    };
    (void)quiesce_can_raw_sample_pack(frame->data, &wire, sizeof frame->data);
}
