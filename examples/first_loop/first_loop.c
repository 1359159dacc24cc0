// The smallest closed loop with the library: a toy structure, shaken at its resonance of 10 Hz. The
// controller measures from the start; after two seconds its output is enabled.
//
// From the root of the repository: cmake --preset host, then cmake --build --preset host --target
// first_loop, then build/host/examples/first_loop. Or with a compiler alone:
// clang-format off
// cc -std=c11 -fno-strict-aliasing $(find firmware -type d -printf '-I%p ') -o first_loop examples/first_loop/first_loop.c $(find firmware -name '*.c' | grep -v -e /comm/) -lm && ./first_loop
// clang-format on

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

// [README]
#include "quiesce.h"

static quiesce_t controller; // all of its memory: nothing is allocated

int main(void) {
    quiesce_params_t params;
    quiesce_params_default(&params); // 1000 ticks a second, the fuzzy law, at most 5 A
    quiesce_init(&controller, &params);
    quiesce_out_t out = {0};
    double x_m = 0.0, v_m_s = 0.0;
    for (uint32_t tick = 0; tick < 4000; tick++) {
        // A toy structure, and a damper that stiffens with the current.
        const double damping_per_s = 4.0 + 2e-3 * out.damper[0].current_cmd_mA;
        const double a_m_s2 = sin(62.8e-3 * tick) - damping_per_s * v_m_s - 3948.0 * x_m;
        v_m_s += 1e-3 * a_m_s2;
        x_m += 1e-3 * v_m_s;
        // One tick of the controller: a sample in, a current out.
        quiesce_in_t in = {.tick = tick, .sensor[0].is_fresh = true, .enable = tick >= 2000};
        in.sensor[0].counts = (int32_t)lround(1e9 * a_m_s2 / params.accel_scale_nm_s2);
        quiesce_step(&controller, &in, &out);
        if (tick % 500 == 499)
            printf("%.1f s: %.2f Hz, %.2f m/s2, %" PRId32 " mA\n", 1e-3 * (tick + 1),
                   1e-6 * out.telemetry.freq_uHz, 1e-6 * out.telemetry.rms_um_s2,
                   out.damper[0].current_cmd_mA);
    }
    return 0;
}
// [/README]
