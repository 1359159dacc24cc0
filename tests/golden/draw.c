#include "draw.h"

#include <string.h>

uint32_t draw_below(uint32_t *seed, uint32_t count) {
    *seed += 0x9E3779B9u;
    uint32_t word = *seed;
    word = (word ^ word >> 16) * 0x21F0AAADu;
    word = (word ^ word >> 15) * 0x735A2D97u;
    word ^= word >> 15;
    return (uint32_t)((uint64_t)word * count >> 32);
}

int32_t draw_between(uint32_t *seed, int32_t low, int32_t high) {
    return (int32_t)(low + (int64_t)draw_below(seed, (uint32_t)high - (uint32_t)low + 1u));
}

bool draw_one_in(uint32_t *seed, uint32_t count) {
    return draw_below(seed, count) == 0;
}

// A parabola a half wave, bent towards the sine.
int32_t draw_sine(int32_t amplitude, uint32_t phase_turn) {
    const int64_t x = (int32_t)phase_turn / 65536; // half turns Q15
    const int64_t arch = x * (32768 - (x < 0 ? -x : x)) / 8192;
    const int64_t bent = arch + (arch * (arch < 0 ? -arch : arch) / 32768 - arch) * 225 / 1000;
    return (int32_t)(amplitude * bent / 32768);
}

// Of laws those that were there when the streams were recorded: the others need tables.
static int32_t most_of(const quiesce_param_info_t *info) {
    return strcmp(info->name, "law") == 0 ? QUIESCE_LAW_PHASE : info->max;
}

static int32_t any_value(uint32_t *seed, const quiesce_param_info_t *info) {
    if (info->choice_count > 0) {
        return info->choices[draw_below(seed, info->choice_count)];
    }
    if (info->default_value == 0 || draw_one_in(seed, 3)) {
        return draw_between(seed, info->min, most_of(info));
    }
    // An eighth to four times the default.
    const int64_t part_q8 = 32 << draw_below(seed, 5);
    const int64_t value = info->default_value * (part_q8 + draw_below(seed, 512)) / 256;
    return (int32_t)(value < info->min ? info->min : value > info->max ? info->max : value);
}

void draw_settings(uint32_t *seed, uint32_t count, quiesce_params_t *params) {
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t index = draw_below(seed, DRAW_PARAMS);
        (void)quiesce_param_set(params, index, any_value(seed, quiesce_param_info(index)));
    }
}

static uint32_t step_turn(uint32_t freq_mHz, int32_t rate_Hz) {
    return (uint32_t)(((uint64_t)freq_mHz << 32) / ((uint64_t)rate_Hz * 1000u));
}

void draw_stretch(uint32_t *seed, int32_t rate_Hz, vibration_t *out) {
    const int32_t amplitude = 8388607 >> draw_below(seed, 16);
    out->left_ticks = 1u + draw_below(seed, 6000);
    out->step_turn[0] = step_turn(500u + draw_below(seed, 52000), rate_Hz);
    out->step_turn[1] = step_turn(500u + draw_below(seed, 52000), rate_Hz);
    out->amplitude[0] = amplitude;
    out->amplitude[1] = amplitude >> draw_below(seed, 16);
    out->noise = amplitude >> draw_below(seed, 16);
    out->offset = draw_between(seed, -4000000, 4000000) >> draw_below(seed, 16);
}

void draw_steady(uint32_t *seed, int32_t rate_Hz, vibration_t *out) {
    const uint32_t step = step_turn(5000u + draw_below(seed, 16000), rate_Hz);
    const int32_t amplitude = draw_between(seed, 2000, 40000);
    *out = (vibration_t){
        .left_ticks = (uint32_t)rate_Hz * (2u + draw_below(seed, 8)),
        .step_turn = {step, 3u * step},
        .amplitude = {amplitude, draw_between(seed, 0, amplitude / 8)},
        .noise = draw_between(seed, 1, 40),
        .offset = draw_between(seed, -2000, 2000),
        .phase_turn = {out->phase_turn[0], out->phase_turn[1]},
    };
}

int32_t draw_sample(uint32_t *seed, vibration_t *vibration) {
    int32_t counts = vibration->offset + draw_between(seed, -vibration->noise, vibration->noise);
    for (uint32_t i = 0; i < 2; i++) {
        vibration->phase_turn[i] += vibration->step_turn[i];
        counts += draw_sine(vibration->amplitude[i], vibration->phase_turn[i]);
    }
    vibration->left_ticks--;
    return counts;
}
