/// Conditioning of a sensor: plausibility, scale, polarity; for an accelerometer, removal of the
/// DC part.
///
/// A bad sample never reaches the windows: the last good one is held, and the fault is reported
/// once the bad run is longer than max_age_ticks; from then on the output is 0 and the DC part is
/// learnt anew. (A stuck or quiet sensor is seen only in hindsight; its samples have been passed
/// on.) A sensor that is slower than the tick is held between its samples.
///
/// Lost: the share of lost samples is followed over some 256 of them; more than most_lost_q16 is a
/// fault until it is less again, however short each gap is.
///
/// Quiet: a live sensor shows noise. The activity of a second of plausible samples is the mean of
/// |x[n] - 2 x[n-1] + x[n-2]|, for white noise 1.95 times its RMS and for a vibration far below the
/// tick rate next to nothing. Less than twice min_noise_counts is a fault at the end of that
/// second; it ends as soon as a later second has gathered enough. A single sample counts at most
/// four times the limit, so that glitches do not pass for noise.
/// Bounded, about 75 instructions a tick.
#ifndef CONDITION_H
#define CONDITION_H

#include "fixq.h"

/// Conditioned accelerations saturate here (51 g), so that every later sum fits its word.
#define CONDITION_ACCEL_LIMIT_um_s2 500000000

/// Why the newest sample is bad; the value is held meanwhile.
typedef enum {
    CONDITION_GOOD = 0,
    CONDITION_LOST = 1,      ///< no sample came
    CONDITION_SATURATED = 2, ///< at the ADC's full scale, or its sender says so
    CONDITION_STUCK = 3,     ///< the same count for stuck_ticks
    CONDITION_RANGE = 4,     ///< beyond the ADC's full scale
    CONDITION_QUIET = 5,     ///< less noise than the sensor has
} condition_flag_t;

typedef struct {
    uint32_t tick_rate_Hz;     ///< 500 .. 4000
    int32_t scale;             ///< thousandths of the unit a count, 1 .. 10^9
    int32_t limit;             ///< values saturate here, > 0
    uint32_t period_ticks;     ///< from one sample to the next, >= 1
    int32_t most_lost_q16;     ///< share of samples that may be lost; 65536, all: no check
    int32_t offset_counts;     ///< at zero acceleration
    int32_t polarity;          ///< -1 or 1
    int32_t full_scale_counts; ///< > 0
    uint32_t max_age_ticks;    ///< longest hold
    uint32_t stuck_ticks;      ///< 0: no check
    uint32_t min_noise_counts; ///< RMS of white noise, at most 65535; 0: no check
    int32_t dc_cutoff_mHz;     ///< 10 .. 1000; 0: the DC part stays
} condition_cfg_t;

/// How lively the samples are.
typedef struct {
    uint32_t limit;          ///< least mean of the second differences, counts; 0: no check
    uint32_t window_samples; ///< a second of them
    int32_t last_counts;     ///< newest plausible sample
    int32_t last_difference; ///< newest minus the one before
    uint32_t activity;       ///< sum of the second differences, each at most 4 x limit
    uint32_t samples;        ///< in that sum
    bool is_quiet;
} condition_noise_t;

typedef struct {
    condition_cfg_t cfg;
    scale_t scale;         ///< unit per count
    int64_t dc_q32;        ///< in Q32
    int32_t dc_gain_q32;   ///< share of the error taken over each tick, below 2^26
    uint32_t mean_most;    ///< of mean_samples: beyond it the plain mean is the slower one
    bool has_value;        ///< a good sample since init or the last fault; dc_q32 is learnt
    uint32_t mean_samples; ///< samples that the starting mean holds, plus one
    int32_t held;          ///< last good sample, before DC removal
    int32_t last_counts;
    uint32_t same_samples; ///< identical samples in a row, the first one included
    condition_noise_t noise;
    condition_flag_t flag; ///< of the newest sample
    bool is_sparse;        ///< more are lost than may be
    uint32_t waited_ticks; ///< for a sample
    int32_t lost_q16;      ///< share of the samples, 65536 is 1
    uint32_t bad_ticks;    ///< since the last good sample; 0 while a slow one is not due
    uint32_t good_ticks;   ///< good samples in a row, saturating; a single missing one takes
                           ///< 4 off
} condition_t;

typedef struct {
    int32_t value;         ///< DC removed; 0 while there is a fault; saturated to the limit
    int32_t raw;           ///< before DC removal: the newest good sample, 0 until there was one
    condition_flag_t flag; ///< of this tick's sample
    bool is_fault;         ///< the bad run is older than max_age_ticks (stuck, quiet: at once)
    uint32_t good_ticks;   ///< good samples in a row, saturating; a single missing one takes
                           ///< 4 off
} condition_out_t;

/// What came in a tick.
typedef struct {
    int32_t counts; ///< ignored unless is_fresh
    bool is_fresh;
    bool is_saturated; ///< its sender says so
} condition_in_t;

void condition_init(condition_t *self, const condition_cfg_t *cfg);

/// One tick.
/// Formats: counts x scale in 64 bit, to nearest, saturated to the limit; DC tracker in Q32,
/// dc += gain (x - dc), gain = w/(1+w), w = 2 pi cutoff / tick rate (backward Euler); at the start
/// the plain mean (gain 1/n) until it is the slower one.
void condition_step(condition_t *self, const condition_in_t *in, condition_out_t *out);

#endif
