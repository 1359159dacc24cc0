#include "signal_chain.h"

#include <stddef.h>

#include "at_start.h"

enum {
    HARMONIC_GAP_uHz = 250000, // a quarter of a bin of the longest window
};

// Latencies are of the sensor that is tracked and of the bus.
static void lock_init(dominant_lock_state_t *self, const dominant_lock_t *lock,
                      const quiesce_board_t *board, const quiesce_params_t *p) {
    const quiesce_board_sensor_t *sensor = &board->sensor[board->tracked];
    lock->init(self, &(dominant_lock_cfg_t){
                         .tick_rate_Hz = (uint32_t)p->tick_rate_Hz,
                         .band_low_mHz = p->band_low_mHz,
                         .band_high_mHz = p->band_high_mHz,
                         .min_accel_um_s2 = p->track_min_accel_um_s2,
                         .latency_us = sensor->latency_us + board->bus_latency_us,
                         .corner_mHz = sensor->corner_mHz,
                     });
}

AT_START void signal_chain_init(signal_chain_t *self, const quiesce_board_t *board,
                                const quiesce_params_t *p, uint64_t needs,
                                const dominant_lock_t *lock) {
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
                                         .spread =
                                             {
                                                 .low_mHz = p->narrow_low_mHz,
                                                 .high_mHz = lock != NULL ? p->narrow_high_mHz : 0,
                                                 .least_um_s2 = p->narrow_least_um_s2,
                                             },
                                     });
    displacement_reset(&self->displacement);
    if (lock != NULL) {
        lock_init(&self->lock, lock, board, p);
    }
    self->hold_ticks = ticks_in_ms(p->track_hold_ms, p->tick_rate_Hz);
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
    const bool is_lost = sample->is_fault || lost_ticks > ESTIMATOR_MOST_BRIDGED;
    estimator_step(&self->estimator, &(estimator_in_t){
                                         .accel_um_s2 = sample->raw,
                                         .is_good = sample->flag == CONDITION_GOOD,
                                         .is_lost = is_lost,
                                         .lost_ticks = is_lost ? 0 : lost_ticks,
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
    in->lock->step(&self->lock,
                   &(dominant_lock_in_t){
                       .sample = out->sample,
                       .velocity_um_s = motion_velocity_um_s(out->velocity_um_s_q32),
                       .rms_um_s2 = out->rms_um_s2,
                       .lost_ticks = in->lost_ticks,
                       .known = &estimate->predictor,
                       .has_published = estimate->has_published,
                       .is_valid = estimate->is_valid,
                       .is_busy = estimate->has_published || rms_has_closed(&self->rms),
                   });
}

static uint32_t tracked_of(const signal_chain_t *self) {
    return QUIESCE_SENSORS == 1 ? 0 : self->tracked;
}

static void show_tone(const signal_chain_t *self, const signal_chain_out_t *out, view_t *view) {
    // A short doubt must not make the command jump: that would itself change the vibration.
    const bool is_known = self->estimator.known.age_ticks <= self->hold_ticks;
    view->valid |= is_known ? VIEW_TONE : 0;
    view->valid |= self->sensing.channel[tracked_of(self)].condition.has_value ? VIEW_RMS : 0;
    view->tone = (view_tone_t){
        .body = QUIESCE_BODIES == 1 ? 0 : self->sensing.places.sensor[tracked_of(self)].at,
        .rms_um_s2 = out->rms_um_s2,
        .freq_uHz = self->estimator.known.tone[0].freq_uHz,
        .is_narrow = self->estimator.known.spread.is_narrow,
    };
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
    show_tone(self, out, view);
    if (in->lock != NULL) {
        hold_on(self, in, out);
        in->lock->show(&self->lock, view);
    }
}
