#include "harmonics.h"

enum { POINTS_A_STEP = 2 };

void harmonic_sums_take(harmonic_sums_t *self, int32_t accel_um_s2, harmonic_wave_t one,
                        harmonic_wave_t three) {
    self->ticks++;
    self->product[HARMONIC_COS1] += (int64_t)accel_um_s2 * one.cos;
    self->product[HARMONIC_SIN1] += (int64_t)accel_um_s2 * one.sin;
    self->product[HARMONIC_COS3] += (int64_t)accel_um_s2 * three.cos;
    self->product[HARMONIC_SIN3] += (int64_t)accel_um_s2 * three.sin;
    self->sum += accel_um_s2;
    self->square += (uint64_t)((int64_t)accel_um_s2 * accel_um_s2) >> HARMONICS_SQUARE_SHIFT;
}

void harmonic_sums_add(harmonic_sums_t *self, const harmonic_sums_t *other) {
    self->ticks += other->ticks;
    for (uint32_t i = 0; i < HARMONIC_PRODUCTS; i++) {
        self->product[i] += other->product[i];
    }
    self->sum += other->sum;
    self->square += other->square;
}

static int32_t limited(int64_t accel_um_s2) {
    return (int32_t)clamp_i64(accel_um_s2, -HARMONICS_LARGEST_um_s2, HARMONICS_LARGEST_um_s2);
}

// Twice the mean of the products, out of Q15.
int32_t harmonic_part_um_s2(const harmonic_sums_t *sums, uint32_t which) {
    return limited((sums->product[which] / (int64_t)sums->ticks) >> 14);
}

uint32_t harmonic_rms_um_s2(const harmonic_sums_t *sums) {
    return sqrt_fast_u64((sums->square / sums->ticks) << HARMONICS_SQUARE_SHIFT);
}

int32_t harmonic_mean_um_s2(const harmonic_sums_t *sums) {
    return limited(sums->sum / (int64_t)sums->ticks);
}

uint32_t harmonic_amp_um_s2(int32_t cos_um_s2, int32_t sin_um_s2) {
    return sqrt_fast_u64((uint64_t)((int64_t)cos_um_s2 * cos_um_s2) +
                         (uint64_t)((int64_t)sin_um_s2 * sin_um_s2));
}

int32_t harmonic_at_um_s2(const harmonic_parts_t *parts, harmonic_wave_t one,
                          harmonic_wave_t three) {
    const int64_t sum_q15 = (int64_t)parts->um_s2[HARMONIC_COS1] * one.cos +
                            (int64_t)parts->um_s2[HARMONIC_SIN1] * one.sin +
                            (int64_t)parts->um_s2[HARMONIC_COS3] * three.cos +
                            (int64_t)parts->um_s2[HARMONIC_SIN3] * three.sin;
    return limited(sum_q15 >> 15);
}

void harmonic_span_start(harmonic_span_t *self, int32_t first, int32_t third,
                         uint32_t third_phase_turn) {
    *self = (harmonic_span_t){
        .first = first,
        .third = third,
        .third_phase_turn = third_phase_turn,
    };
}

int32_t harmonic_span_at(const harmonic_span_t *self, uint32_t phase_turn) {
    const uint32_t third_turn = 3u * phase_turn + self->third_phase_turn;
    const int64_t sum_q25 = (int64_t)self->first * cos_linear_q25(phase_turn) +
                            (int64_t)self->third * cos_linear_q25(third_turn);
    return (int32_t)clamp_i64(sum_q25 >> 25, -INT32_MAX, INT32_MAX);
}

bool harmonic_span_step(harmonic_span_t *self) {
    for (uint32_t i = 0; i < POINTS_A_STEP && self->point < HARMONIC_SPAN_POINTS; i++) {
        const uint32_t turn = self->point * (0x80000000u / HARMONIC_SPAN_POINTS);
        const int32_t size = abs_i32(harmonic_span_at(self, turn));
        self->largest = size > self->largest ? size : self->largest;
        self->point++;
        if (self->point == HARMONIC_SPAN_POINTS) {
            return true;
        }
    }
    return false;
}
