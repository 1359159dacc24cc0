#include "adapt_effect.h"

#include <stddef.h>

void adapt_meter_reset(adapt_meter_t *self) {
    self->is_collecting = false;
    self->done = 0;
    self->taken = 0;
    self->halves = 0;
    self->stage = 0;
    self->sums = (harmonic_sums_t){0};
}

static int32_t amp_um_s2(const adapt_meter_t *self, uint32_t cos, uint32_t sin) {
    return (int32_t)harmonic_amp_um_s2(self->parts.um_s2[cos], self->parts.um_s2[sin]);
}

static uint32_t peak_turn(const adapt_meter_t *self, uint32_t cos, uint32_t sin) {
    return harmonic_peak_turn(self->parts.um_s2[cos], self->parts.um_s2[sin]);
}

// Half peak-to-peak of the displacement, times (2 pi f)^2: the third harmonic counts a ninth.
static void start_search(adapt_meter_t *self) {
    const uint32_t third_turn = peak_turn(self, HARMONIC_COS3, HARMONIC_SIN3);
    harmonic_span_start(&self->span, self->span.first, self->span.third / 9,
                        3u * self->peak_turn - third_turn);
}

// One stage a tick. Returns true iff the effect is complete.
static bool work(adapt_meter_t *self) {
    const uint32_t stage = self->stage;
    self->stage++;
    if (stage <= HARMONIC_PRODUCTS) {
        self->parts.um_s2[stage - 1u] = harmonic_part_um_s2(&self->sums, stage - 1u);
        return false;
    }
    switch (stage - HARMONIC_PRODUCTS) {
    case 1:
        self->span.first = amp_um_s2(self, HARMONIC_COS1, HARMONIC_SIN1);
        return false;
    case 2:
        self->span.third = amp_um_s2(self, HARMONIC_COS3, HARMONIC_SIN3);
        return false;
    case 3:
        self->peak_turn = peak_turn(self, HARMONIC_COS1, HARMONIC_SIN1);
        return false;
    case 4:
        start_search(self);
        return false;
    case 5:
        self->part[self->done].rms_um_s2 = harmonic_rms_um_s2(&self->sums);
        return false;
    default:
        return harmonic_span_step(&self->span);
    }
}

// Half cycles, from the first one that began after the vibration had settled.
static void collect(adapt_meter_t *self, const harmonic_sums_t *half, uint32_t part_ticks) {
    if (!self->is_collecting) {
        self->is_collecting = true;
        return;
    }
    harmonic_sums_add(&self->sums, half);
    self->halves++;
    self->stage = self->sums.ticks >= part_ticks && self->halves % 2u == 0 ? 1 : 0;
}

bool adapt_meter_step(adapt_meter_t *self, const harmonic_sums_t *half, uint32_t part_ticks) {
    if (self->stage == 0) {
        if (half != NULL) {
            collect(self, half, part_ticks);
        }
        return false;
    }
    if (!work(self)) {
        return false;
    }
    self->part[self->done].reach_um_s2 = (uint32_t)self->span.largest;
    self->done++;
    self->taken++;
    self->halves = 0;
    self->stage = 0;
    self->sums = (harmonic_sums_t){0};
    return self->done == 2u;
}

adapt_effect_t adapt_meter_effect(const adapt_meter_t *self) {
    const adapt_effect_t *part = self->part;
    return (adapt_effect_t){
        .reach_um_s2 = (part[0].reach_um_s2 + part[1].reach_um_s2) / 2u,
        .rms_um_s2 = (part[0].rms_um_s2 + part[1].rms_um_s2) / 2u,
    };
}

void adapt_meter_go_on(adapt_meter_t *self) {
    self->part[0] = self->part[1];
    self->done = 1;
}
