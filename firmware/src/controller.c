// INTERIM: constant and off laws only, so that the rest links. Being replaced.
#include "quiesce.h"
#include <string.h>
typedef struct { quiesce_params_t p; bool ok; } c_t;
bool quiesce_init(quiesce_t *self, const quiesce_params_t *params) {
    c_t *c = (c_t *)(void *)self->opaque;
    c->p = *params; c->ok = quiesce_params_check(params, 0); return c->ok;
}
void quiesce_step(quiesce_t *self, const quiesce_in_t *in, quiesce_out_t *out) {
    const c_t *c = (const c_t *)(const void *)self->opaque;
    memset(out, 0, sizeof *out);
    out->telemetry.tick = in->tick;
    out->telemetry.accel_um_s2 = in->accel_counts;
    out->telemetry.state = in->enable ? QUIESCE_STATE_RUN : QUIESCE_STATE_IDLE;
    out->driver_enable = true;
    if (in->enable && c->p.law == QUIESCE_LAW_CONSTANT) out->current_cmd_mA = c->p.constant_current_mA;
    out->telemetry.current_cmd_mA = out->current_cmd_mA;
}
