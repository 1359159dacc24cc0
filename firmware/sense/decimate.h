/// Anti-alias decimation, to 250 Hz or some other rate, by a chain of half-band filters.
///
/// Every stage: 11 taps Q16, symmetric; 0 .. 50 Hz flat to
/// 0.0063 dB a stage, stop band -62 dB (nothing
/// above 200 Hz reaches the band 0 .. 50 Hz). Linear phase: the delay is exactly
/// DECIMATE_DELAY(ratio) ticks for every frequency, the memory twice that. Samples are limited to
/// +-(2^29 - 1). Bounded, about 35 instructions a stage that runs.
#ifndef DECIMATE_H
#define DECIMATE_H

#include "fixq.h"

#define DECIMATE_RATE_Hz 250
#define DECIMATE_MAX_STAGES 4
#define DECIMATE_EVEN 5 ///< inputs before the newest that a filter needs, of the newest's parity
#define DECIMATE_ODD 3  ///< and of the other one
#define DECIMATE_LIMIT 536870911

/// Delay in ticks at `ratio` ticks a sample: 5 inputs of each stage.
#define DECIMATE_DELAY(ratio) (5u * ((ratio)-1u))

typedef struct {
    int32_t even[DECIMATE_EVEN]; ///< newest first
    int32_t odd[DECIMATE_ODD];
    bool is_odd;
} decimate_stage_t;

typedef struct {
    decimate_stage_t stage[DECIMATE_MAX_STAGES];
    uint32_t stages; ///< a sample every 2^stages ticks
} decimate_t;

/// tick_rate_Hz: 500, 1000, 2000 or 4000. sample_rate_Hz: that divided by 1, 2, 4, .. 16; a tick
/// rate below it stays as it is.
void decimate_init(decimate_t *self, uint32_t tick_rate_Hz, uint32_t sample_rate_Hz);

/// One tick's sample in *value. Returns true iff *value has become a sample at the lower rate.
bool decimate_step(decimate_t *self, int32_t *value);

#endif
