#include "lives.h"

#include <inttypes.h>
#include <stdio.h>

void life_judge(life_t *self, const quiesce_in_t *in, const quiesce_out_t *out) {
    const rule_t broken = rules_tick(&self->rules, in, out);
    if (broken != RULES && self->first[0] == '\0') {
        const quiesce_telemetry_t *t = &out->telemetry;
        (void)snprintf(self->first, sizeof self->first,
                       "%s in life %" PRIu64 ", tick %" PRIu64 ": state %" PRIu32 ", fault %" PRIu32
                       ", %" PRId32 " mA, driver %d",
                       rule_names[broken], self->number, self->rules.ticks, t->state, t->fault,
                       out->damper[0].current_cmd_mA, out->damper[0].driver_enable);
    }
}
