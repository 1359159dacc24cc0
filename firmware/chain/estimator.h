/// What vibrates, and how: the estimator that the parameters name, of those that the build holds.
///
/// fit: sliding DFTs and least squares (estimator_fit.h). fft: the transform of the last 1.024 s
/// under a Hann window, every 50 ms (estimator_fft.h). They share one memory. This is the only
/// place that knows which there are.
#ifndef ESTIMATOR_H
#define ESTIMATOR_H

#include "estimate.h"
#include "quiesce_params.h"
#include "quiesce_size.h"
#if QUIESCE_WITH_FIT
#include "estimator_fit.h"
#endif
#if QUIESCE_WITH_FFT
#include "estimator_fft.h"
#endif

typedef union {
    estimate_t known; ///< what is published, whichever it is
#if QUIESCE_WITH_FIT
    estimator_fit_t fit;
#endif
#if QUIESCE_WITH_FFT
    estimator_fft_t fft;
#endif
} estimator_t;

/// cfg->method is one that the build holds.
static inline void estimator_init(estimator_t *self, const estimator_cfg_t *cfg) {
#if QUIESCE_WITH_FFT
    if (cfg->method == QUIESCE_ESTIMATOR_FFT) {
        estimator_fft_init(&self->fft, cfg);
        return;
    }
#endif
#if QUIESCE_WITH_FIT
    estimator_fit_init(&self->fit, cfg);
#endif
}

/// One tick.
static inline void estimator_step(estimator_t *self, const estimator_in_t *in) {
#if QUIESCE_WITH_FFT
    if (!QUIESCE_WITH_FIT || self->known.method == QUIESCE_ESTIMATOR_FFT) {
        estimator_fft_step(&self->fft, in);
        return;
    }
#endif
#if QUIESCE_WITH_FIT
    estimator_fit_step(&self->fit, in);
#endif
}

#endif
