// A current that a small network makes of measurements, for each damper by itself: what imitates
// any controller, radial basis functions, rules with conclusions of first order.
//
// Its table: networks (network.h), one a damper from the first on, whose inputs' signals are those
// of view_signal.h and whose own number is 0. `quiesce law fit` writes them.
#include "law.h"
#include "network.h"
#include "sections.h"
#include "view_signal.h"

#define NETWORK_MAGIC UINT32_C(0x314E4E51)

_Static_assert(sizeof(network_past_t) * QUIESCE_DAMPERS <= LAW_STATE_BYTES,
               "the arena is too small");

static bool is_good(const uint32_t *section) {
    const network_t *network = network_of(section);
    bool are_signals = true;
    for (uint32_t i = 0; i < network->inputs; i++) {
        are_signals = are_signals && view_signal_is_good(network->input[i].signal);
    }
    return network->own == 0 && are_signals && network_is_good(network);
}

static uint64_t needs(const uint32_t *section, uint32_t damper) {
    const network_t *network = network_of(section);
    uint64_t bits = 0;
    (void)damper;
    for (uint32_t i = 0; i < network->inputs; i++) {
        bits |= view_signal_needs(network->input[i].signal);
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

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    network_past_t *past = state;
    const network_t *network = sections_first(setup->table);
    law_demand_all(out, 0);
    for (uint32_t i = 0; i < sections_count(setup->table); i++) {
        int32_t values[NETWORK_MOST_INPUTS];
        for (uint32_t k = 0; k < network->inputs; k++) {
            values[k] = view_signal_value(view, network->input[k].signal);
        }
        out->value[i] = network_current_mA(network, &past[i], values);
        network = network_next(network);
    }
    return true;
}

static const table_kind_t networks = {
    .name = "network",
    .magic = NETWORK_MAGIC,
    .least_words = SECTIONS_FIRST,
    .check = check,
    .needs = needs_of_table,
    .rate_Hz = network_table_rate_Hz,
};

extern const law_t law_network;
const law_t law_network = {.name = "network", .kind = &networks, .step = step};
