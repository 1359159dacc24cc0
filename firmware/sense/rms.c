#include "rms.h"

enum { BLOCKS_PER_SECOND = 100, SMALLEST_BLOCK_TICKS = 5, LEAST_SHIFT = 5 };

void rms_init(rms_t *self, uint32_t tick_rate_Hz, uint32_t window_ms) {
    *self = (rms_t){
        .window_blocks = window_ms / 10u,
        .block_ticks = tick_rate_Hz / BLOCKS_PER_SECOND,
        .shift = LEAST_SHIFT,
    };
    for (uint32_t ticks = SMALLEST_BLOCK_TICKS; ticks < self->block_ticks; ticks *= 2u) {
        self->shift++;
    }
}

void rms_reset(rms_t *self) {
    self->total = 0;
    self->open_sum = 0;
    self->next = 0;
    self->filled = 0;
    self->open_ticks = 0;
    self->rms_um_s2 = 0;
}

static int32_t root_of_mean(const rms_t *self) {
    // total = 5/2^5 of the sum of the blocks' mean squares.
    const uint64_t mean = div_u64_u16(self->total, self->filled * SMALLEST_BLOCK_TICKS);
    return (int32_t)isqrt_u64(mean << LEAST_SHIFT);
}

static void close_block(rms_t *self) {
    const uint64_t closed = self->open_sum >> self->shift;
    // A slot that the window has not filled since the last reset holds nothing to take away.
    const bool is_full = self->filled == self->window_blocks;
    self->total += closed - (is_full ? self->block[self->next] : 0u);
    self->block[self->next] = closed;
    self->next = self->next + 1u == self->window_blocks ? 0 : self->next + 1u;
    self->filled += is_full ? 0u : 1u;
    self->open_sum = 0;
    self->open_ticks = 0;
    self->rms_um_s2 = root_of_mean(self);
}

int32_t rms_step(rms_t *self, int32_t accel_um_s2) {
    self->open_sum += (uint64_t)((int64_t)accel_um_s2 * accel_um_s2);
    self->open_ticks++;
    if (self->open_ticks == self->block_ticks) {
        close_block(self);
    }
    return self->rms_um_s2;
}
