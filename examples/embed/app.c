// A vibration of 10 Hz for the controller: exits 0 where it has found it after three seconds, and
// commands a current.
#include "quiesce.h"

static quiesce_t controller; // all of its memory: nothing is allocated

// Acceleration in mm/s2: a parabola for each half period of 50 ticks.
static int32_t vibration(uint32_t tick) {
    const int32_t at = (int32_t)(tick % 50u);
    const int32_t bow = 4 * at * (50 - at);
    return tick % 100u < 50u ? bow : -bow;
}

int main(void) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    if (!quiesce_init(&controller, &params)) {
        return 1;
    }
    quiesce_out_t out = {0};
    for (uint32_t tick = 0; tick < 3000; tick++) {
        quiesce_in_t in = {.tick = tick, .sensor[0].is_fresh = true, .enable = tick >= 1000};
        in.sensor[0].counts = vibration(tick) * 1000 / (params.accel_scale_nm_s2 / 1000);
        quiesce_step(&controller, &in, &out);
    }
    const int32_t off_uHz = out.telemetry.freq_uHz - 10000000;
    return off_uHz > -20000 && off_uHz < 20000 && out.damper[0].current_cmd_mA > 0 ? 0 : 1;
}
