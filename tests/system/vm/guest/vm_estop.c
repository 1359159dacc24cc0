/* vm_estop INTERFACE PULL_FILE PRESSES: presses and releases the emergency stop PRESSES times, each
 * at another phase of the control tick, and finds the first demand frame that is safe after it.
 *
 * PULL_FILE: gpio-sim's file that pulls the line. Waits before each press until the output is on,
 * and after it acknowledges the fault. Prints one line a press: the line's level was changed after
 * `pressed_ns`, the frame left at `safe_ns` (kernel time stamps, CLOCK_MONOTONIC), and
 * `late_frames` demand frames with the output still on came in between. */
#include "guest_bus.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum {
    PERIOD_NS = 1000000,
    PHASES = 16,
    RAMP_TICKS = 50,     /* with the output on before a press */
    COMMAND_TICKS = 100, /* from one command to the next */
};

typedef struct {
    int bus;
    int pull;
    uint8_t alive;
    uint32_t ticks;
    guest_hand_t hand;
} probe_t;

static void pull(const probe_t *probe, const char *level) {
    if (pwrite(probe->pull, level, strlen(level), 0) < 0) {
        guest_fail("gpio-sim");
    }
}

static guest_frame_t next_demand(const probe_t *probe) {
    guest_frame_t in;
    if (!guest_bus_receive(probe->bus, &in)) {
        guest_fail("the interface went down");
    }
    return in;
}

/* Commands with fault_reset, in turn two of 1 and two of 0, until the output has been on a while.
 */
static void wait_running(probe_t *probe) {
    uint32_t on_ticks = 0;
    while (on_ticks < RAMP_TICKS) {
        const guest_frame_t in = next_demand(probe);
        const guest_demand_t demand = guest_demand(&in.frame);
        on_ticks = demand.is_enabled && demand.current_mA > 0 ? on_ticks + 1 : 0;
        guest_hand_see(&probe->hand, &demand);
        if (probe->ticks++ % COMMAND_TICKS == 0) {
            can_frame_t out;
            const bool acknowledges = probe->alive / 2 % 2 != 0 && on_ticks == 0;
            guest_command(&out, guest_hand_enables(&probe->hand), acknowledges, &probe->alive);
            guest_bus_send(probe->bus, &out);
        }
    }
}

static void press(probe_t *probe, uint32_t number) {
    const int64_t start_ns = guest_now_ns() / PERIOD_NS * PERIOD_NS + 5 * PERIOD_NS;
    uint32_t late_frames = 0;
    guest_sleep_until(start_ns + number % PHASES * (PERIOD_NS / PHASES));
    const int64_t pressed_ns = guest_now_ns();
    pull(probe, "pull-up");
    for (;;) {
        const guest_frame_t in = next_demand(probe);
        const guest_demand_t demand = guest_demand(&in.frame);
        if (in.time_ns < pressed_ns) {
            continue;
        }
        if (!demand.is_enabled) {
            printf("RESULT {\"name\": \"press%" PRIu32 "\", \"pressed_ns\": %" PRId64
                   ", \"safe_ns\": %" PRId64 ", \"current_mA\": %" PRId32
                   ", \"late_frames\": %" PRIu32 "}\n",
                   number, pressed_ns, in.time_ns, demand.current_mA, late_frames);
            return;
        }
        late_frames++;
    }
}

int main(int argc, char **argv) {
    static const uint32_t ids[] = {0x010};
    if (argc != 4) {
        return 2;
    }
    const uint32_t presses = (uint32_t)guest_number(argv[3], 1, 1000);
    probe_t probe = {.bus = guest_bus_open(argv[1], ids, 1), .pull = open(argv[2], O_WRONLY)};
    if (probe.pull < 0) {
        guest_fail(argv[2]);
    }
    guest_real_time(70);
    for (uint32_t i = 0; i < presses; i++) {
        wait_running(&probe);
        press(&probe, i);
        pull(&probe, "pull-down");
    }
    wait_running(&probe);
    return 0;
}
