#include "estimate.h"

enum {
    STEADY_FRACTION = 12,    // of the frequency: what moves no further is steady ..
    STEADY_AMP_FRACTION = 3, // .. and of the amplitude
    MOST_FAILURES = 2,       // of trust in a row, before it is given more slowly
};

void estimate_init(estimate_t *self, const estimator_cfg_t *cfg, uint32_t sample_rate_Hz,
                   uint32_t window_ticks) {
    *self = (estimate_t){.method = (uint8_t)cfg->method, .age_ticks = UINT32_MAX};
    for (uint32_t rate = cfg->tick_rate_Hz; rate > DECIMATE_RATE_Hz; rate /= 2u) {
        self->stages++;
    }
    decimate_init(&self->decimate, cfg->tick_rate_Hz, sample_rate_Hz);
    tracker_init(&self->tracker, &cfg->tracker);
    velocity_init(&self->velocity, cfg->tracker.band_low_mHz, cfg->tracker.band_high_mHz);
    spread_init(&self->spread, &cfg->spread);
    predictor_init(&self->predictor, self->stages);
    self->trust_ticks = 3u * window_ticks / 2u;
}

void estimate_forget(estimate_t *self) {
    predictor_disarm(&self->predictor);
    tracker_reset(&self->tracker);
    self->valid_ticks = 0;
}

bool estimate_decide(estimate_t *self, const tracker_tone_t *tones, uint32_t count,
                     int32_t residual_um_s2, uint32_t explained_q16) {
    tracker_t *tracker = &self->tracker;
    const bool was_plain = tracker->is_valid && self->is_plain;
    const bool is_good = tracker_decide(tracker, tones, count, residual_um_s2, explained_q16);
    self->is_plain = tracker->is_clear && (self->failures < MOST_FAILURES || self->is_valid ||
                                           !tracker->window.is_longest);
    if (was_plain && !(tracker->is_valid && self->is_plain)) {
        estimate_end(self);
    }
    return is_good;
}

void estimate_end(estimate_t *self) {
    if (self->valid_ticks >= self->trust_ticks) {
        self->failures = 0;
    } else if (self->valid_ticks > 0 && self->failures < MOST_FAILURES) {
        self->failures++;
    }
    self->valid_ticks = 0;
}

int32_t estimate_filter_memory(const estimate_t *self) {
    const uint32_t stages = self->decimate.stages;
    const uint32_t ratio = 1u << stages;
    return (int32_t)((2u * DECIMATE_DELAY(ratio) + ratio - 1u) >> stages);
}

// amplitude / (2 pi f)^2 in nm.
static int32_t displacement_nm(int32_t amp_um_s2, int32_t freq_uHz) {
    // 1000 / (4 pi^2) x 10^6 = 25330296 with the frequency in mHz.
    const uint64_t freq_mHz = ((uint32_t)freq_uHz + 500u) / 1000u;
    const uint64_t nm = (uint64_t)(uint32_t)amp_um_s2 * 25330296u / (freq_mHz * freq_mHz);
    return (int32_t)(nm > INT32_MAX ? INT32_MAX : nm);
}

// Whether a and b are more than a / fraction apart.
static bool differs(uint32_t a, uint32_t b, uint32_t fraction) {
    return gap_u32(a, b) > a / fraction;
}

static void stay(estimate_t *self, const tracker_tone_t *dominant) {
    if (differs(dominant->turn, self->steady_turn, STEADY_FRACTION) ||
        differs((uint32_t)dominant->amp_um_s2, self->steady_amp_um_s2, STEADY_AMP_FRACTION)) {
        self->steady_turn = dominant->turn;
        self->steady_amp_um_s2 = (uint32_t)dominant->amp_um_s2;
        self->steady_ticks = 0;
    }
}

void estimate_publish(estimate_t *self, uint32_t half_ticks, const predictor_rest_t *rest) {
    const tracker_t *tracker = &self->tracker;
    predictor_tone_t tones[ESTIMATOR_TONES];
    for (uint32_t i = 0; i < ESTIMATOR_TONES; i++) {
        const tracker_tone_t *tone = &tracker->tone[i];
        tones[i] = (predictor_tone_t){
            .phase_turn = tone->phase_turn +
                          (uint32_t)(((uint64_t)tone->turn * half_ticks) >> (self->stages + 1u)),
            .step_turn = tone->turn >> self->stages,
            .amp_um_s2 = tone->amp_um_s2,
        };
        self->tone[i] = i < tracker->in_band
                            ? (estimator_tone_t){
                                  .freq_uHz = tone->freq_uHz,
                                  .amp_um_s2 = tone->amp_um_s2,
                                  .displacement_nm =
                                      displacement_nm(tone->amp_um_s2, tone->freq_uHz),
                              }
                            : (estimator_tone_t){0};
    }
    predictor_load(&self->predictor, tones, tracker->tones, rest);
    stay(self, &tracker->tone[0]);
    self->sigma_uHz = tracker_freq_uHz(tracker->tone[0].sigma_turn);
    self->has_published = true;
}
