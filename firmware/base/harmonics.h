/// A vibration's fundamental and third harmonic: correlated with a running phase, and how far they
/// reach together.
///
/// Formats: accelerations um/s2, |x| <= 2^29; phases in turns Q32; waves in Q15.
#ifndef HARMONICS_H
#define HARMONICS_H

#include "trig.h"

#define HARMONICS_SQUARE_SHIFT 12
#define HARMONICS_LARGEST_um_s2 (1 << 29)

/// Which product: acceleration with cosine and sine of the phase, and of three times the phase.
enum { HARMONIC_COS1, HARMONIC_SIN1, HARMONIC_COS3, HARMONIC_SIN3, HARMONIC_PRODUCTS };

/// What some ticks held. 2^12 ticks and more fit.
typedef struct {
    uint32_t ticks;
    int64_t product[HARMONIC_PRODUCTS]; ///< sums, Q15
    int64_t sum;                        ///< of the acceleration
    uint64_t square;                    ///< sum of its squares, each >> HARMONICS_SQUARE_SHIFT
} harmonic_sums_t;

/// The components: um_s2[COS1] x cos(phase) + um_s2[SIN1] x sin(phase) + the same of the third.
typedef struct {
    int32_t um_s2[HARMONIC_PRODUCTS];
} harmonic_parts_t;

/// Cosine and sine of a phase, Q15.
typedef struct {
    int32_t cos;
    int32_t sin;
} harmonic_wave_t;

static inline harmonic_wave_t harmonic_wave(uint32_t turn) {
    return (harmonic_wave_t){cos_linear_q25(turn) >> 10,
                             cos_linear_q25(turn - UINT32_C(0x40000000)) >> 10};
}

/// Takes a tick's acceleration in. one, three: waves of its phase and of three times that.
void harmonic_sums_take(harmonic_sums_t *self, int32_t accel_um_s2, harmonic_wave_t one,
                        harmonic_wave_t three);

/// Adds other ticks up with these.
void harmonic_sums_add(harmonic_sums_t *self, const harmonic_sums_t *other);

/// One part, RMS (floor) and mean of sums with ticks > 0, um/s2. A division each.
int32_t harmonic_part_um_s2(const harmonic_sums_t *sums, uint32_t which);
uint32_t harmonic_rms_um_s2(const harmonic_sums_t *sums);
int32_t harmonic_mean_um_s2(const harmonic_sums_t *sums);

/// Amplitude of the component with these parts, floor; and the phase at which it is largest.
uint32_t harmonic_amp_um_s2(int32_t cos_um_s2, int32_t sin_um_s2);
static inline uint32_t harmonic_peak_turn(int32_t cos_um_s2, int32_t sin_um_s2) {
    return atan2_turn(sin_um_s2, cos_um_s2);
}

/// The components at a phase.
int32_t harmonic_at_um_s2(const harmonic_parts_t *parts, harmonic_wave_t one,
                          harmonic_wave_t three);

/// Search for the largest magnitude of first x cos(p) + third x cos(3 p + third_phase) over p, at
/// 32 points of a half cycle (both are odd about half a cycle): between points it is at most 0.5 %
/// of the fundamental and 1.1 % of the third harmonic higher. Any unit.
typedef struct {
    int32_t first; ///< amplitudes, >= 0
    int32_t third;
    uint32_t third_phase_turn;
    uint32_t point; ///< of the search, HARMONIC_SPAN_POINTS: finished
    int32_t largest;
} harmonic_span_t;

#define HARMONIC_SPAN_POINTS 32u

/// Begins a search.
void harmonic_span_start(harmonic_span_t *self, int32_t first, int32_t third,
                         uint32_t third_phase_turn);

/// Goes on by two points. Returns true iff this finished the search: largest is the result.
bool harmonic_span_step(harmonic_span_t *self);

/// The sum at a phase of the fundamental, saturated.
int32_t harmonic_span_at(const harmonic_span_t *self, uint32_t phase_turn);

#endif
