#include "velocity.h"

#define RATE_mHz 250000u

void velocity_init(velocity_t *self, int32_t band_low_mHz, int32_t band_high_mHz) {
    *self = (velocity_t){.band_low_mHz = band_low_mHz, .band_high_mHz = band_high_mHz};
}

// First bin whose middle lies at freq or above.
static uint32_t bin_from(int32_t freq_mHz, uint32_t points_log2) {
    return (((uint32_t)freq_mHz << points_log2) + RATE_mHz - 1u) / RATE_mHz;
}

void velocity_start(velocity_t *self, uint32_t points_log2) {
    // Half a bin of room: a tone at the edge of the band belongs to it.
    const int32_t room_mHz = (int32_t)(RATE_mHz >> (points_log2 + 1u));
    const int32_t low_mHz = self->band_low_mHz > room_mHz ? self->band_low_mHz - room_mHz : 0;
    self->points_log2 = points_log2;
    self->first_bin = bin_from(low_mHz, points_log2);
    self->end_bin = bin_from(self->band_high_mHz + room_mHz, points_log2);
    self->sum = 0;
}

void velocity_read(velocity_t *self, const uint64_t *power, uint32_t first, uint32_t end) {
    const uint32_t from = first > self->first_bin ? first : self->first_bin;
    const uint32_t to = end < self->end_bin ? end : self->end_bin;
    for (uint32_t k = from; k < to; k++) {
        self->sum += over_square(power[k], k);
    }
}

void velocity_end(velocity_t *self) {
    // v^2 = sum / 3 x (N / (2 pi 250))^2: of a tone's A^2 the Hann bins hold 1.5, its mean square
    // is a half. 1 / (3 (2 pi 250)^2) = 297077 / 2^41.
    const uint32_t up = 2u * self->points_log2;
    const uint64_t square = self->sum >> 44 == 0 ? (self->sum * 297077u) >> (41u - up)
                                                 : ((self->sum >> 19) * 297077u) >> (22u - up);
    self->rms_um_s = (int32_t)sqrt_fast_u64(square);
}
