/// Least-squares fit of up to three sinusoids to a window of samples, all together: the rectangular
/// window at full efficiency, with the image at negative frequency, the constant part and the
/// leakage between the components in the equations rather than in the result.
///
/// About each start frequency w the model is linear, x(m) = a cos(w m) + b sin(w m) + u (q cos(w m)
/// + p sin(w m)), m counted from the middle of the window and u = m / (N/2): the slopes give the
/// frequency's correction, (b q - a p) / (a^2 + b^2) / (N/2), and take up growth and decay. One
/// step turns an error of d bins into about d^3, and d^2 / 4 more by the image (up to 3 d^2 below
/// two cycles a window), so that three calls from 0.3 bins off reach the maximum likelihood
/// estimate. Its normal equations split into an even and an odd half (functions of m); their
/// coefficients are closed sums. Where a slow drift is announced, a component of half a cycle a
/// window stands for it.
///
/// Formats: frequencies in turns a sample, Q32; data scaled to 19 .. 22 bits as the window
/// requires, mean removed; projections Q24 x 22 bits summed in 64 bit; matrices Q30. Residuals are
/// good to 5 x 10^-4 of the largest amplitude. Bounded: 25 instructions a pair of samples and
/// component, 200 a pair of components and 500 a call of the rest; each call of step() does about
/// as much as `pairs` pairs of samples.
#ifndef TONE_FIT_H
#define TONE_FIT_H

#include "ldlt.h"
#include "trig.h"

#define TONE_FIT_TONES 3
#define TONE_FIT_SLOTS (TONE_FIT_TONES + 1) ///< and one for a drift
#define TONE_FIT_MAX_LOG2 8
#define TONE_FIT_MAX_PAIRS (1 << (TONE_FIT_MAX_LOG2 - 1))

/// One fitted component, at the middle of the window.
typedef struct {
    uint32_t turn;       ///< frequency, turns a sample Q32
    int32_t shift_q29;   ///< correction of the start frequency, radians over half a window
    uint32_t phase_turn; ///< x = amp cos(phase)
    int32_t amp_um_s2;
    uint32_t sigma_turn; ///< standard deviation of turn, as far as the residual is white
} tone_t;

typedef enum {
    TONE_FIT_IDLE,
    TONE_FIT_GATHER,
    TONE_FIT_GATHERED,
    TONE_FIT_PROJECT,
    TONE_FIT_PROJECTED,
    TONE_FIT_COUPLE,
    TONE_FIT_SOLVE_EVEN,
    TONE_FIT_SOLVE_ODD,
    TONE_FIT_SUM_UP,
    TONE_FIT_READ,
    TONE_FIT_DONE,
} tone_fit_stage_t;

typedef struct {
    const int32_t *ring; ///< samples, a power of two of them
    uint32_t ring_mask;
    uint32_t newest; ///< ring index of the window's newest sample
    uint32_t points_log2;
    int32_t mean_um_s2;  ///< of the window, roughly
    uint32_t size_um_s2; ///< largest magnitude about it that is to be expected; a guess
} tone_fit_window_t;

typedef struct {
    int64_t even_cos;
    int64_t even_slope_sin;
    int64_t odd_sin;
    int64_t odd_slope_cos;
} tone_fit_sums_t;

typedef struct {
    int32_t even[TONE_FIT_MAX_PAIRS]; ///< x(m) + x(-m)
    int32_t odd[TONE_FIT_MAX_PAIRS];  ///< x(m) - x(-m)
    tone_fit_window_t window;
    tone_fit_stage_t stage;
    uint32_t done;          ///< pairs, of the stage and component at work
    uint32_t slot;          ///< component at work
    uint32_t other;         ///< its partner, while coupling
    uint32_t slots;         ///< components, a drift included
    uint32_t bits;          ///< of all magnitudes, ored
    int32_t up_shift;       ///< data = samples << up_shift
    int32_t residual_um_s2; ///< standard deviation of what the fit leaves
    uint64_t energy;        ///< sum of squares of the data, times two
    int64_t constant;       ///< sum of the data
    int32_t turn_cos_q30;
    int32_t turn_sin_q30;
    int32_t step_cos_q30;
    int32_t step_sin_q30;
    tone_fit_sums_t sums;
    ldlt_t even_half;
    ldlt_t odd_half;
    uint32_t tones; ///< components that are wanted
    tone_t tone[TONE_FIT_SLOTS];
    int32_t constant_um_s2; ///< constant part of the fit
    int32_t end_um_s2;      ///< and of what is slow, at the end of the window
    int32_t slope_um_s2;    ///< and how fast that changes there, in half a window
    int32_t bend_um_s2;     ///< how far off its line it may be an eighth of half a window later
    uint32_t explained_q16; ///< share of the energy about the mean that the fit explains
    uint64_t residual_q16;  ///< variance of what it leaves, data units
} tone_fit_t;

void tone_fit_init(tone_fit_t *self);

/// Takes a window's samples in (twice where size_um_s2 was 4 times wrong). The ring must keep them
/// until gathered() is true.
void tone_fit_start(tone_fit_t *self, const tone_fit_window_t *window);

/// Start frequencies (turns a sample), at least 0.3 cycles a window and about a cycle a window
/// apart; count <= TONE_FIT_TONES. Call once gathered() is true.
void tone_fit_set(tone_fit_t *self, const uint32_t *turns, uint32_t count, bool has_drift);

/// One slice. Returns true iff it waits for the caller: gathered, or done.
bool tone_fit_step(tone_fit_t *self, uint32_t pairs);

#endif
