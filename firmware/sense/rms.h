/// Windowed RMS by exact integer add and remove, in blocks of 10 ms. It cannot drift: what a block
/// adds is what it takes away later.
///
/// Scaling: with |x| <= 5 x 10^8 a block's sum of squares (at most 40 ticks) stays below 2^64. A
/// closed block keeps sum >> shift, shift = 5 + log2(ticks of a block / 5), so that 400 of them fit
/// 64 bit too. Result: floor of the root in um/s2; resolution 6 um/s2 near zero. Bounded: about 10
/// instructions a tick and 150 more once a block.
#ifndef RMS_H
#define RMS_H

#include "fixq.h"

#define RMS_MAX_BLOCKS 400

typedef struct {
    uint64_t block[RMS_MAX_BLOCKS]; ///< ring of finished blocks
    uint64_t total;                 ///< sum of the ring
    uint64_t open_sum;              ///< sum of squares of the unfinished block
    uint32_t window_blocks;
    uint32_t block_ticks;
    uint32_t shift;
    uint32_t next;       ///< slot of the ring that is replaced next
    uint32_t filled;     ///< finished blocks in the ring
    uint32_t open_ticks; ///< samples in the unfinished block
    int32_t rms_um_s2;   ///< over the finished blocks in the window; 0 before the first
} rms_t;

/// Whether the last step closed a block, which is most of the work.
static inline bool rms_has_closed(const rms_t *self) {
    return self->open_ticks == 0;
}

/// tick_rate_Hz: 500, 1000, 2000 or 4000. window_ms: 100 .. 4000, rounded down to 10 ms.
void rms_init(rms_t *self, uint32_t tick_rate_Hz, uint32_t window_ms);

/// Forgets all samples; the RMS is 0 until the next block is full.
void rms_reset(rms_t *self);

/// One sample, |accel_um_s2| <= 5 x 10^8. Returns the RMS over the window, um/s2 (shorter while it
/// fills).
int32_t rms_step(rms_t *self, int32_t accel_um_s2);

#endif
