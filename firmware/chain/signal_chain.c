#include "signal_chain.h"

#include <stddef.h>

#include "trig.h"

enum {
    HARMONIC_GAP_uHz = 250000, // a quarter of a bin of the longest window
};

static uint32_t step_turn_of(int32_t freq_mHz, uint32_t rate_Hz) {
    return (uint32_t)(((uint64_t)(uint32_t)freq_mHz << 32) / (1000u * rate_Hz));
}

// Of the sensor that is tracked and of the bus, to nearest; the coil's lag is the table's.
static uint32_t latency_q8(const quiesce_board_t *board, uint32_t rate_Hz) {
    const int32_t latency_us = board->sensor[board->tracked].latency_us + board->bus_latency_us;
    return (uint32_t)(((uint64_t)(uint32_t)latency_us * rate_Hz * 256u + 500000u) / 1000000u);
}

void signal_chain_init(signal_chain_t *self, const quiesce_board_t *board,
                       const quiesce_params_t *p, uint64_t needs) {
    const uint32_t rate_Hz = (uint32_t)p->tick_rate_Hz;
    sensing_init(&self->sensing, board, p, needs);
    self->tracked = (uint8_t)board->tracked;
    rms_init(&self->rms, rate_Hz, (uint32_t)p->rms_window_ms);
    estimator_init(&self->estimator, &(estimator_cfg_t){
                                         .method = p->estimator,
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
    dominant_lock_init(&self->lock, rate_Hz, step_turn_of(p->band_low_mHz, rate_Hz),
                       step_turn_of(p->band_high_mHz, rate_Hz), p->track_min_accel_um_s2);
    self->hold_ticks = ticks_in_ms(p->track_hold_ms, p->tick_rate_Hz);
    self->latency_q8 = latency_q8(board, rate_Hz);
    self->corner_step_turn = step_turn_of(board->sensor[board->tracked].corner_mHz, rate_Hz);
}

// The published third harmonic of the dominant component; 0: none (0 is the dominant one itself).
static uint32_t third_harmonic(const estimate_t *estimate) {
    const int32_t third_uHz = 3 * estimate->tone[0].freq_uHz;
    for (uint32_t i = 1; i < ESTIMATOR_TONES; i++) {
        const int32_t freq_uHz = estimate->tone[i].freq_uHz;
        if (freq_uHz != 0 && abs_i32(freq_uHz - third_uHz) <= HARMONIC_GAP_uHz) {
            return i;
        }
    }
    return 0;
}

static void load_displacement(signal_chain_t *self) {
    const estimate_t *estimate = &self->estimator.known;
    const uint32_t third = third_harmonic(estimate);
    const uint32_t phase =
        estimate_phase_turn(estimate, third) - 3u * estimate_phase_turn(estimate, 0);
    displacement_load(&self->displacement, estimate->tone[0].displacement_nm,
                      third == 0 ? 0 : estimate->tone[third].displacement_nm, phase);
}

static int32_t follow(signal_chain_t *self, const condition_out_t *sample, uint32_t lost_ticks) {
    estimator_step(&self->estimator, &(estimator_in_t){
                                         .accel_um_s2 = sample->raw,
                                         .is_good = sample->flag == CONDITION_GOOD,
                                         .is_lost = sample->is_fault || lost_ticks > 0,
                                     });
    if (self->estimator.known.has_published) {
        load_displacement(self);
    }
    return displacement_step(&self->displacement, estimate_phase_turn(&self->estimator.known, 0));
}

// Through the law that asked for it: a build without one holds no lock.
static void hold_on(signal_chain_t *self, const signal_chain_in_t *in,
                    const signal_chain_out_t *out) {
    const estimate_t *estimate = &self->estimator.known;
    in->lock->step(&self->lock, &(dominant_lock_in_t){
                                    .sample = out->sample,
                                    .velocity_um_s = motion_velocity_um_s(out->velocity_um_s_q32),
                                    .rms_um_s2 = out->rms_um_s2,
                                    .lost_ticks = in->lost_ticks,
                                    .tone = estimate->has_published && estimate->is_valid
                                                ? &estimate->predictor.tone[0]
                                                : NULL,
                                });
}

static uint32_t tracked_of(const signal_chain_t *self) {
    return QUIESCE_SENSORS == 1 ? 0 : self->tracked;
}

// From the phase that the sensor shows to that of the structure when this tick's command reaches
// its driver: on by the latencies, back by what a first-order high-pass leads, atan(corner / f).
static void turn_phase(const signal_chain_t *self, view_tone_t *tone) {
    const int32_t corner_step_turn = (int32_t)self->corner_step_turn;
    tone->phase_turn += (uint32_t)((uint64_t)tone->step_turn * self->latency_q8 >> 8);
    if (corner_step_turn != 0) {
        tone->phase_turn -= atan2_turn(corner_step_turn, (int32_t)tone->step_turn);
    }
}

static void show_tone(const signal_chain_t *self, const signal_chain_out_t *out, view_t *view) {
    const lock_in_t *lock = &self->lock.in;
    // A short doubt must not make the command jump: that would itself change the vibration.
    const bool is_known = self->estimator.known.age_ticks <= self->hold_ticks;
    view->valid |= (is_known ? VIEW_TONE : 0) | (lock->is_locked ? VIEW_LOCK : 0);
    view->valid |= self->sensing.channel[tracked_of(self)].condition.has_value ? VIEW_RMS : 0;
    view->tone = (view_tone_t){
        .body = QUIESCE_BODIES == 1 ? 0 : self->sensing.places.sensor[tracked_of(self)].at,
        .rms_um_s2 = out->rms_um_s2,
        .freq_uHz = self->estimator.known.tone[0].freq_uHz,
        .phase_turn = lock->phase_turn,
        .step_turn = lock->step_turn,
        .half = lock->has_half ? &lock->last : NULL,
    };
    turn_phase(self, &view->tone);
}

void signal_chain_step(signal_chain_t *self, const signal_chain_in_t *in, view_t *view,
                       signal_chain_out_t *out) {
    sensing_step(&self->sensing, in->samples, view);
    const channel_t *channel = &self->sensing.channel[tracked_of(self)];
    out->sample = &channel->sample;
    out->velocity_um_s_q32 = channel->motion.velocity_um_s_q32;
    if (out->sample->is_fault) {
        // What was taken in before the fault was seen must not outlive it.
        rms_reset(&self->rms);
    }
    out->rms_um_s2 = rms_step(&self->rms, out->sample->value);
    out->displacement_nm = follow(self, out->sample, in->lost_ticks);
    if (in->lock != NULL) {
        hold_on(self, in, out);
    }
    show_tone(self, out, view);
}
