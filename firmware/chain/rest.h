/// Whether the structure is at rest: its RMS acceleration has been below rest_rms_um_s2 for
/// rest_ms. A single tick of more ends it. Bounded, about 10 instructions.
#ifndef REST_H
#define REST_H

#include "fixq.h"
#include "quiesce_params.h"
#include "view.h"

typedef struct {
    uint32_t ticks; ///< below that in a row, saturating
} rest_t;

static inline bool rest_step(rest_t *self, const view_t *view, const quiesce_params_t *params) {
    const bool is_still =
        (view->valid & VIEW_RMS) != 0 && view->tone.rms_um_s2 < params->rest_rms_um_s2;
    self->ticks = is_still ? increment_sat_u32(self->ticks) : 0u;
    return self->ticks >= (uint32_t)params->rest_ms / 1000u * (uint32_t)params->tick_rate_Hz;
}

#endif
