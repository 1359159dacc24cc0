/* vm_node INTERFACE sensor|all: a sensor node and, with `all`, an operator, paced by the
 * controller: each demand frame is answered with a sample, every 100th with an operator's command.
 * No clock: a controller that is late gets its sample all the same. SIGUSR1: the next two
 * commands acknowledge a fault and two more do not, whatever comes meanwhile: a press is an edge.
 * Stays while the interface is down. */
#include "guest_bus.h"

#include <signal.h>
#include <string.h>
#include <unistd.h>

enum { COMMAND_EVERY = 100, SAMPLES = 100, PRESSED = 2, RELEASED = 2 };

static volatile sig_atomic_t press; /* commands left of a press and its release */

static void on_signal(int number) {
    (void)number;
    press = press > 0 ? press : PRESSED + RELEASED;
}

/* A triangle of 10 Hz at 1000 samples a second with some noise, so that no sensor fault sees it. */
static int32_t next_counts(uint32_t tick, uint32_t *noise) {
    *noise = *noise * 1664525u + 1013904223u;
    const int32_t phase = (int32_t)(tick % SAMPLES);
    const int32_t triangle = phase < SAMPLES / 2 ? phase : SAMPLES - phase;
    return (triangle - SAMPLES / 4) * 600 + (int32_t)(*noise >> 25) - 64;
}

int main(int argc, char **argv) {
    static const uint32_t ids[] = {0x010};
    can_frame_t out;
    guest_frame_t in;
    uint32_t noise = 1;
    uint8_t sample_alive = 0;
    uint8_t command_alive = 0;
    guest_hand_t hand = {0};
    if (argc != 3) {
        return 2;
    }
    const struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    sigaction(SIGUSR1, &action, NULL);
    const bool has_operator = strcmp(argv[2], "all") == 0;
    const int bus = guest_bus_open(argv[1], ids, 1);
    guest_real_time(60);
    for (uint32_t tick = 0;;) {
        /* While the interface is down the next read waits. */
        if (!guest_bus_receive(bus, &in) || !guest_is_demand(&in.frame)) {
            continue;
        }
        const guest_demand_t demand = guest_demand(&in.frame);
        guest_hand_see(&hand, &demand);
        guest_sample(&out, next_counts(tick, &noise), &sample_alive);
        guest_bus_send(bus, &out);
        if (has_operator && tick % COMMAND_EVERY == 0) {
            guest_command(&out, guest_hand_enables(&hand), press > RELEASED, &command_alive);
            press -= press > 0;
            guest_bus_send(bus, &out);
        }
        tick++;
    }
}
