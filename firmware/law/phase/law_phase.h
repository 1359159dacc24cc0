/// The phase law: a pulse of current at the right phase of every half cycle, from a table over
/// frequency, trimmed on line to the plant at hand.
///
/// Below resonance the damper holds on until just after the peak and lets go: it works like a
/// spring that gives nothing back. Above resonance it lets go on the way out: like a mass. The
/// table knows where (docs/explanation/phase-law.md).
///
/// While nothing is locked on to, the request is unlock_current_mA. From there the pulses are faded
/// in over phase_blend_ms, so that the vibration changes slowly enough to be followed.
#ifndef LAW_PHASE_H
#define LAW_PHASE_H

#include "adapt.h"
#include "phase_table.h"
#include "quiesce_params.h"

typedef struct {
    const phase_table_t *table;
    const phase_point_t *points; ///< of the setting in use
    uint32_t point_count;
    adapt_t adapt;
    uint32_t blend_step_q16; ///< a tick
    uint32_t blend_q16;      ///< 0: unlock current, 65536: pulses
    bool is_stale;           ///< place and pulse are to be found anew
    bool is_frozen;          ///< adaptation stands still, whatever the parameter says
    uint32_t freq_mHz;
    phase_place_t place;
    phase_pulse_t pulse; ///< trimmed
    adapt_trim_t trim;   ///< in effect
} law_phase_t;

/// Starts unlocked, nothing learnt. The table has been checked and must stay.
void law_phase_init(law_phase_t *self, const quiesce_params_t *params, const phase_table_t *table);

#endif
