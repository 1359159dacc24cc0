// The control loop of a board: nothing in it is the board's own but the end.
#include "backend.h"
#include "quiesce.h"

#define RUN_TICKS 3000u
#define ARM_TICK 1000u // its edge arms
#define FREQUENCY_uHz 10000000
#define TOLERANCE_uHz 20000

enum { EXIT_WELL, EXIT_REFUSED, EXIT_NOT_FOUND, EXIT_NO_CURRENT, EXIT_TICKS_LOST };

static quiesce_t controller; // all of its memory: nothing is allocated

static int judge(const quiesce_out_t *out, const hal_current_t *driver, uint32_t lost) {
    const int32_t off_uHz = out->telemetry.freq_uHz - FREQUENCY_uHz;
    if (off_uHz < -TOLERANCE_uHz || off_uHz > TOLERANCE_uHz) {
        return EXIT_NOT_FOUND;
    }
    if (!driver->is_enabled || driver->command_mA <= 0) {
        return EXIT_NO_CURRENT;
    }
    return lost > 0 ? EXIT_TICKS_LOST : EXIT_WELL;
}

int main(void) {
    hal_tick_t tick;
    hal_accel_t accel = {0};
    hal_current_t driver = {0};
    quiesce_params_t params;
    quiesce_params_default(&params);
    if (!quiesce_init(&controller, &params) ||
        !hal_tick_start(&tick, (uint32_t)params.tick_rate_Hz)) {
        backend_exit(EXIT_REFUSED);
    }
    quiesce_in_t in = {0};
    quiesce_out_t out = {0};
    uint32_t lost = 0;
    while (in.tick < RUN_TICKS) {
        const uint32_t elapsed = hal_tick_elapsed(&tick);
        if (elapsed == 0) {
            continue;
        }
        lost += elapsed - 1u;
        in.tick += elapsed;
        in.enable = in.tick >= ARM_TICK;
        in.sensor[0].is_fresh = hal_accel_read(&accel, HAL_AXIS_Z, &in.sensor[0].counts);
        in.driver[0].is_measured = hal_current_read(&driver, &in.driver[0].current_mA);
        quiesce_step(&controller, &in, &out);
        hal_current_write(&driver, out.damper[0].current_cmd_mA, out.damper[0].driver_enable);
    }
    backend_exit(judge(&out, &driver, lost));
}
