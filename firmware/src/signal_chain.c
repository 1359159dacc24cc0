#include "signal_chain.h"

void signal_chain_init(signal_chain_t *self, const quiesce_params_t *p) {
    const uint32_t rate_Hz = (uint32_t)p->tick_rate_Hz;
    condition_init(&self->condition, &(condition_cfg_t){
                                         .tick_rate_Hz = rate_Hz,
                                         .scale_nm_s2 = p->accel_scale_nm_s2,
                                         .offset_counts = p->accel_offset_counts,
                                         .polarity = p->accel_polarity,
                                         .full_scale_counts = p->accel_full_scale_counts,
                                         .max_age_ticks = (uint32_t)p->sensor_max_age_ticks,
                                         .stuck_ticks = (uint32_t)p->sensor_stuck_ticks,
                                         .min_noise_counts = (uint32_t)p->sensor_min_noise_counts,
                                         .dc_cutoff_mHz = p->dc_cutoff_mHz,
                                     });
    rms_init(&self->rms, rate_Hz, (uint32_t)p->rms_window_ms);
    spectrum_init(&self->spectrum, rate_Hz);
    tracker_init(&self->tracker, &(tracker_cfg_t){
                                     .band_low_mHz = p->band_low_mHz,
                                     .band_high_mHz = p->band_high_mHz,
                                     .min_accel_um_s2 = p->track_min_accel_um_s2,
                                     .snr_dB = p->track_snr_dB,
                                     .rate_uHz = SPECTRUM_RATE_Hz * 1000000u,
                                     .points_log2 = SPECTRUM_POINTS_LOG2,
                                     .window_rounds = SPECTRUM_POINTS,
                                 });
    motion_init(&self->motion, rate_Hz, p->velocity_cutoff_mHz);
}

static void track(signal_chain_t *self, const condition_out_t *sample, bool has_gap) {
    const spectrum_span_t span = spectrum_step(&self->spectrum, sample->accel_um_s2);
    tracker_read(&self->tracker, self->spectrum.power, span.first, span.end);
    if (span.is_round_end) {
        tracker_end_round(&self->tracker, self->spectrum.power);
    }
    tracker_tick(&self->tracker, !sample->is_fault && !has_gap);
}

void signal_chain_step(signal_chain_t *self, const signal_chain_in_t *in, signal_chain_out_t *out) {
    condition_step(&self->condition, in->accel_counts, in->is_fresh, &out->sample);
    if (out->sample.is_fault) {
        // What was taken in before the fault was seen must not outlive it.
        rms_reset(&self->rms);
        motion_reset(&self->motion);
    }
    out->rms_um_s2 = rms_step(&self->rms, out->sample.accel_um_s2);
    track(self, &out->sample, in->has_gap);
    out->velocity_um_s_q32 = motion_step(&self->motion, out->sample.accel_um_s2);
}
