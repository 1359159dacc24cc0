/// The known components, run on from tick to tick, and the watch over them: is the vibration still
/// what it was?
///
/// Every sample is compared with its prediction. The differences are averaged over blocks of 2, 8
/// and 32 ms; of the squared averages, less three times the noise and twice a tolerance of 1/1024
/// of the amplitudes' squares, a cumulative sum is kept that never falls below zero (E. S. Page's
/// test). It crosses its limit within a few blocks of a change, and by white noise alone (without
/// any tolerance) about once in 40,000 blocks; since when it has been positive tells when the
/// change began. The noise is learnt from the differences themselves; their slow part (drift, below
/// about 0.6 Hz) is taken out.
///
/// Formats: phases in turns Q32; squares in (um/s2)^2, 64 bit; differences limited to 2^27.
/// Bounded, about 25 instructions a tick and 15 a component, 40 more a block.
#ifndef PREDICTOR_H
#define PREDICTOR_H

#include "trig.h"

#define PREDICTOR_TONES 3
#define PREDICTOR_SCALES 3

typedef struct {
    uint32_t phase_turn; ///< now
    uint32_t step_turn;  ///< a tick
    int32_t amp_um_s2;
} predictor_tone_t;

/// Page's test on blocks of one length.
typedef struct {
    int64_t open;    ///< sum of the unfinished block's differences
    int64_t average; ///< of the last finished block
    int64_t noise;   ///< mean square of a block's average
    int64_t sum;
    uint32_t suspect_blocks; ///< since the sum was zero
    uint32_t left;           ///< blocks of the scale below that it still lacks
    bool is_due;             ///< the last finished block has not been judged yet
} predictor_watch_t;

typedef enum {
    PREDICTOR_FITS = 0,
    PREDICTOR_CHANGED = 1, ///< the vibration is not what it was; suspect_ticks tells since when
    PREDICTOR_BACK = 2,    ///< after CHANGED: it was a small burst, the samples fit again
} predictor_verdict_t;

typedef struct {
    predictor_tone_t tone[PREDICTOR_TONES];
    uint32_t tones;
    uint8_t stages;
    bool is_armed;          ///< watching
    bool is_suspicious;     ///< since CHANGED; only BACK or disarming ends it
    int32_t drift_um_s2_q8; ///< of the offset, a tick
    int64_t offset_q12;     ///< constant and slow part of the samples
    int64_t noise_alarm;    ///< of the noise, see judge
    int64_t tolerance;      ///< mean square that the components may be off
    predictor_watch_t watch[PREDICTOR_SCALES];
    int64_t burst;            ///< mean square since it began, over as many blocks as it may last
    uint32_t calm_blocks;     ///< that fitted again, in a row
    uint32_t suspect_ticks;   ///< at an alarm: how long ago the change began
    int32_t prediction_um_s2; ///< of this tick's sample
} predictor_t;

/// stages: ticks a decimated sample, as a power of two, 1 .. 4.
void predictor_init(predictor_t *self, uint32_t stages);

/// What goes with the components.
typedef struct {
    int32_t mean_um_s2;     ///< constant part now
    int32_t drift_um_s2_q8; ///< its change a tick
    int32_t bend_um_s2;     ///< how far it may be off that line; 0: it does not drift
    bool is_clear;          ///< the components explain most of the samples
    int32_t noise_um_s2;    ///< standard deviation of decimated samples
} predictor_rest_t;

/// New components (count <= PREDICTOR_TONES), phases as of now. The constant part is taken over
/// when it drifts or the watch was disarmed, else it goes on as it was learnt; the noise only in
/// the latter case.
void predictor_load(predictor_t *self, const predictor_tone_t *tones, uint32_t count,
                    const predictor_rest_t *rest);

/// Stops watching; the components run on.
void predictor_disarm(predictor_t *self);

/// One tick: advances the components and looks at the sample (unless !is_good). Samples that fit
/// again for 40 ms after CHANGED, with less than 0.8 % of the longest window's energy in between,
/// make it BACK.
predictor_verdict_t predictor_step(predictor_t *self, int32_t accel_um_s2, bool is_good);

#endif
