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

#include "law.h"
#include "phase_table.h"
#include "quiesce.h"

/// Uses other pulses from the next tick on; nothing is learnt about them yet. A table that is
/// refused changes nothing. The words must stay.
phase_table_verdict_t law_phase_use(law_state_t *state, const quiesce_params_t *params,
                                    const uint32_t *words, uint32_t count);

/// What has been learnt, as the ADAPT_STORE_WORDS words of adapt_store.h.
void law_phase_save(const law_state_t *state, const quiesce_params_t *params, uint32_t *words);

/// Puts it back. Returns false, and changes nothing, iff it is not this table's and setting's, or
/// damaged, or beyond the limits.
bool law_phase_load(law_state_t *state, const quiesce_params_t *params, const uint32_t *words);

/// Forgets it.
void law_phase_reset(law_state_t *state);

/// Learning stands still, whatever the parameter says; a table that is put to use changes nothing
/// about that.
void law_phase_freeze(law_state_t *state, bool is_frozen);

/// What telemetry says of it: adapt_* and trim_*.
void law_phase_report(const law_state_t *state, quiesce_telemetry_t *t);

#endif
