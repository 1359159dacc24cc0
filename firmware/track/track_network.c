// The current that a small network makes of the demand and of what is known of the damper: an
// inverse that is learned, with its temperature where that is measured.
//
// Its table: networks (network.h), one a damper from the first on. An input's signal is a quantity
// of the damper itself by the number of view_signal.h, or VIEW_SIGNAL_DEMAND; the demand is among
// them, and the damper's force or the velocity of its stroke: the way that a demand has to go with,
// the force where both are. The own number is a speed in um/s: slower than it the damper counts as
// if it moved at it, the way of the demand. A demand against the way is 0 to the network and gets
// no current, nor does a damper without a network. `quiesce identify inverse --method network,svr`
// writes them.
#include <stddef.h>

#include "fixq.h"
#include "network.h"
#include "track.h"
#include "view_signal.h"

#define TRACK_NETWORK_MAGIC UINT32_C(0x314E5451)

_Static_assert(sizeof(network_past_t) <= TRACK_STATE_BYTES, "the state is too small");

static bool sees(const network_t *network, uint32_t signal) {
    bool found = false;
    for (uint32_t i = 0; i < network->inputs; i++) {
        found = found || network->input[i].signal == signal;
    }
    return found;
}

static bool is_of_damper(uint32_t signal) {
    return (signal >= QUIESCE_SENSE_STROKE && signal <= QUIESCE_SENSE_TEMPERATURE) ||
           signal == VIEW_SIGNAL_CURRENT;
}

static bool is_good(const uint32_t *section) {
    const network_t *network = network_of(section);
    bool are_signals =
        sees(network, VIEW_SIGNAL_DEMAND) &&
        (sees(network, QUIESCE_SENSE_FORCE) || sees(network, QUIESCE_SENSE_STROKE_VELOCITY));
    for (uint32_t i = 0; i < network->inputs; i++) {
        const uint32_t signal = network->input[i].signal;
        are_signals = are_signals && (signal == VIEW_SIGNAL_DEMAND || is_of_damper(signal));
    }
    return network->own <= VIEW_LIMIT && are_signals && network_is_good(network);
}

static uint64_t needs(const uint32_t *section, uint32_t damper) {
    const network_t *network = network_of(section);
    uint64_t bits = 0;
    for (uint32_t i = 0; i < network->inputs; i++) {
        const uint32_t signal = network->input[i].signal;
        bits |= signal == VIEW_SIGNAL_DEMAND ? 0 : view_signal_needs(signal) << damper;
    }
    return bits;
}

static const sections_kind_t sections = {network_size, is_good, needs};

static quiesce_table_verdict_t check(const uint32_t *words) {
    return network_table_check(&sections, words);
}

static uint64_t needs_of_table(const uint32_t *words) {
    return sections_need(&sections, words);
}

static const network_t *of_damper(const uint32_t *words, uint32_t damper) {
    const network_t *network = sections_first(words);
    for (uint32_t i = 0; i < damper; i++) {
        network = network_next(network);
    }
    return network;
}

// With the speed that it counts as.
static view_damper_t moving(const view_damper_t *damper, int32_t least_um_s, int32_t demand_mN) {
    view_damper_t out = *damper;
    if (demand_mN != 0 && abs_i32(damper->velocity_um_s) < least_um_s) {
        out.velocity_um_s = demand_mN > 0 ? least_um_s : -least_um_s;
    }
    return out;
}

static int32_t value_of(const view_damper_t *damper, uint32_t signal) {
    const size_t offset = view_quantity[signal].offset - offsetof(view_t, damper);
    return *(const int32_t *)(const void *)((const uint8_t *)damper + offset);
}

static int32_t step(void *state, const track_setup_t *setup, const view_damper_t *damper,
                    int32_t demand_mN) {
    if (setup->damper >= sections_count(setup->table)) {
        return 0;
    }
    const network_t *network = of_damper(setup->table, setup->damper);
    const int32_t way =
        sees(network, QUIESCE_SENSE_FORCE) ? damper->force_mN : damper->velocity_um_s;
    const int32_t wanted_mN = track_is_feasible(demand_mN, way) ? demand_mN : 0;
    const view_damper_t as = moving(damper, (int32_t)network->own, wanted_mN);
    int32_t values[NETWORK_MOST_INPUTS];
    for (uint32_t i = 0; i < network->inputs; i++) {
        const uint32_t signal = network->input[i].signal;
        values[i] = signal == VIEW_SIGNAL_DEMAND ? wanted_mN : value_of(&as, signal);
    }
    const int32_t current_mA = network_current_mA(network, state, values);
    return wanted_mN != 0 ? current_mA : 0;
}

static const table_kind_t networks = {
    .name = "inverse_network",
    .magic = TRACK_NETWORK_MAGIC,
    .least_words = SECTIONS_FIRST,
    .check = check,
    .needs = needs_of_table,
    .rate_Hz = network_table_rate_Hz,
};

extern const track_t track_network;
const track_t track_network = {.name = "network", .kind = &networks, .step = step};
