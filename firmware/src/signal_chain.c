#include "signal_chain.h"

enum {
    HARMONIC_GAP_uHz = 250000, // a quarter of a bin of the longest window
    YOUNG_CYCLES = 2,
    ELSEWHERE_DIVISOR = 32, // a lock 3 % off the dominant component is on something else
};

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
    estimator_init(&self->estimator, &(estimator_cfg_t){
                                         .tick_rate_Hz = rate_Hz,
                                         .longest_ms = (uint32_t)p->track_window_ms,
                                         .hop_ms = (uint32_t)p->track_hop_ms,
                                         .tracker =
                                             {
                                                 .band_low_mHz = p->band_low_mHz,
                                                 .band_high_mHz = p->band_high_mHz,
                                                 .min_accel_um_s2 = p->track_min_accel_um_s2,
                                                 .snr_dB = p->track_snr_dB,
                                             },
                                     });
    displacement_reset(&self->displacement);
    motion_init(&self->motion, rate_Hz, p->velocity_cutoff_mHz);
    lock_in_init(&self->lock, rate_Hz);
}

// The published third harmonic of the dominant component; 0: none (0 is the dominant one itself).
static uint32_t third_harmonic(const estimator_t *estimator) {
    const int32_t third_uHz = 3 * estimator->tone[0].freq_uHz;
    for (uint32_t i = 1; i < ESTIMATOR_TONES; i++) {
        const int32_t freq_uHz = estimator->tone[i].freq_uHz;
        if (freq_uHz != 0 && abs_i32(freq_uHz - third_uHz) <= HARMONIC_GAP_uHz) {
            return i;
        }
    }
    return 0;
}

static void load_displacement(signal_chain_t *self) {
    const estimator_t *estimator = &self->estimator;
    const uint32_t third = third_harmonic(estimator);
    const uint32_t phase =
        estimator_phase_turn(estimator, third) - 3u * estimator_phase_turn(estimator, 0);
    displacement_load(&self->displacement, estimator->tone[0].displacement_nm,
                      third == 0 ? 0 : estimator->tone[third].displacement_nm, phase);
}

static int32_t follow(signal_chain_t *self, const condition_out_t *sample, bool has_gap) {
    estimator_step(&self->estimator, &(estimator_in_t){
                                         .accel_um_s2 = sample->raw_um_s2,
                                         .is_good = sample->flag == CONDITION_GOOD,
                                         .is_lost = sample->is_fault || has_gap,
                                     });
    if (self->estimator.has_published) {
        load_displacement(self);
    }
    return displacement_step(&self->displacement, estimator_phase_turn(&self->estimator, 0));
}

static bool is_elsewhere(const lock_in_t *lock, uint32_t step_turn) {
    const uint32_t apart =
        lock->step_turn > step_turn ? lock->step_turn - step_turn : step_turn - lock->step_turn;
    return !lock->is_locked || apart > step_turn / ELSEWHERE_DIVISOR;
}

// Locks on to what the estimator trusts, and holds on to it by itself.
static void hold_on(signal_chain_t *self, const condition_out_t *sample, bool has_gap) {
    if (sample->is_fault || has_gap) {
        lock_in_release(&self->lock);
    }
    lock_in_step(&self->lock, sample->raw_um_s2, sample->flag == CONDITION_GOOD);
    const predictor_tone_t *tone = &self->estimator.predictor.tone[0];
    if (!estimator_is_valid(&self->estimator)) {
        // A young lock does not know yet what to expect.
        if (self->lock.cycles < YOUNG_CYCLES) {
            lock_in_release(&self->lock);
        }
    } else if (self->estimator.has_published && is_elsewhere(&self->lock, tone->step_turn)) {
        lock_in_acquire(&self->lock, tone->phase_turn, tone->step_turn,
                        self->estimator.tone[0].amp_um_s2, sample->raw_um_s2 - sample->accel_um_s2);
    }
}

void signal_chain_step(signal_chain_t *self, const signal_chain_in_t *in, signal_chain_out_t *out) {
    condition_step(&self->condition, in->accel_counts, in->is_fresh, &out->sample);
    if (out->sample.is_fault) {
        // What was taken in before the fault was seen must not outlive it.
        rms_reset(&self->rms);
        motion_reset(&self->motion);
    }
    out->rms_um_s2 = rms_step(&self->rms, out->sample.accel_um_s2);
    out->displacement_nm = follow(self, &out->sample, in->has_gap);
    if (in->wants_lock) {
        hold_on(self, &out->sample, in->has_gap);
    }
    out->velocity_um_s_q32 = motion_step(&self->motion, out->sample.accel_um_s2);
}
