/// FFT of the last 2^points_log2 real samples under a Hann window, of which bins 1 .. 52 are wanted
/// and made, worked off in small items.
///
/// N / 2 complex numbers, an even sample and the odd one after it, are R interleaved rows of 32
/// (decimation in time: J. W. Cooley, J. W. Tukey, Math. Comp. 19(90), 1965). Each row's transform
/// is radix 2, in place. Bin k is the sum over rows r of exp(-2 pi i 2r k / N) row_r[k mod 32],
/// formed for the wanted bins only, +k and -k; from both comes the bin of the real samples.
///
/// Block floating point: the largest magnitude about the window's mean sets one shift for the whole
/// block, so that under the Hann window (Q29, to nearest) it fills 27 bits and a sign. Each of the
/// 5 stages of a row halves, products to nearest, the other term towards minus infinity: no complex
/// magnitude grows, nothing can overflow. The sums over rows are 32 bit, each term halved and
/// rounded to nearest (16 rows x 2^27.5 / 2 x 1/2, the window's mean, is below 2^30). Bins leave in
/// um/s2, to nearest, saturated to +-2^30.
///
/// Bounded: each item costs what the table in fft.c says, some 1.5 x 10^5 instructions for 1024
/// points. Memory 5.5 kB.
#ifndef FFT_H
#define FFT_H

#include "fixq.h"

#define FFT_MAX_LOG2 10
#define FFT_ROW 32
#define FFT_LAST_BIN 52
/// Samples that may come in while a transform runs, before they would overwrite its own.
#define FFT_ROOM 64
#define FFT_RING ((1 << FFT_MAX_LOG2) + FFT_ROOM)

typedef struct {
    int32_t re;
    int32_t im;
} fft_bin_t;

typedef enum { FFT_IDLE, FFT_SCALE, FFT_LOAD, FFT_TURN, FFT_ADD, FFT_SHOW, FFT_STAGES } fft_stage_t;

typedef struct {
    uint32_t points_log2;
    uint32_t newest; ///< ring index of the newest sample
    int64_t total;   ///< of the last 2^points_log2 samples
    fft_stage_t stage;
    uint32_t done; ///< items of the stage
    uint32_t row_at_work;
    uint32_t oldest;    ///< ring index of the first sample of the window at work
    int32_t mean_um_s2; ///< of that window, floor
    uint32_t bits;      ///< of all magnitudes about it, ored
    uint32_t up;        ///< its samples are shifted left by that much before they are halved
    fft_bin_t row[FFT_ROW];
    fft_bin_t mirror[FFT_LAST_BIN + 1]; ///< bins -k, from k = 1
    /// From index 1, um/s2, once the transform has finished: a tone of amplitude A and phase p at
    /// the middle of the window makes (-1)^k A exp(i p) where a bin's middle meets it.
    fft_bin_t bin[FFT_LAST_BIN + 1];
    int32_t sample[FFT_RING];
} fft_t;

/// points_log2: 6 .. FFT_MAX_LOG2.
void fft_init(fft_t *self, uint32_t points_log2);

/// A new sample, |accel_um_s2| < 2^29.
void fft_push(fft_t *self, int32_t accel_um_s2);

/// A transform of the newest samples begins; one that is at work is given up.
void fft_start(fft_t *self);

/// Works off items, about one instruction for each unit of *credit, while there is enough for the
/// next one. Returns true iff that has finished the transform.
bool fft_work(fft_t *self, int32_t *credit);

/// Credit that a whole transform takes.
uint32_t fft_cost(const fft_t *self);

#endif
