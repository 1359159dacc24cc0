/// The last writer of the command: range, slew, safe current.
///
/// Default-deny: only a request that the supervisor allows passes, limited in range and slew; all
/// else becomes the safe current, at once (the slew limit never delays safety). Units mA; slew
/// accumulates in uA a tick, floor, at least 1 uA. Bounded, about 20 instructions.
#ifndef GUARD_H
#define GUARD_H

#include "fixq.h"

typedef struct {
    int32_t max_mA;    ///< > 0
    int32_t safe_mA;   ///< 0 .. max_mA
    int32_t slew_mA_s; ///< >= 1000
    uint32_t tick_rate_Hz;
} guard_cfg_t;

/// Words only: it is kept with its twin (base/twin.h).
typedef struct {
    int32_t max_mA;
    int32_t safe_mA;
    int32_t slew_uA; ///< largest change a tick
    int32_t last_uA;
} guard_t;

/// Starts at the safe current. A configuration out of its ranges is clamped into them, so that even
/// a refused parameter set leaves a defined safe current.
void guard_init(guard_t *self, const guard_cfg_t *cfg);

/// Command in mA, 0 .. max_mA.
int32_t guard_step(guard_t *self, int32_t request_mA, bool is_allowed);

#endif
