// The current whose force, between models of the damper at constant currents that remember the
// motion, is the demand. No force is measured. Whether a demand can be met is judged by the models'
// forces: beside its velocity a damper with hysteresis, and a spring, have a direction of their
// own.
#include <stddef.h>

#include "force_bank.h"
#include "sections.h"
#include "track.h"

_Static_assert(sizeof(force_bank_t) <= TRACK_STATE_BYTES, "the state is too small");

static int32_t step(void *state, const track_setup_t *setup, const view_damper_t *damper,
                    int32_t demand_mN) {
    const uint32_t *section = force_bank_section(setup->table, setup->damper);
    if (section == NULL) {
        return 0;
    }
    force_bank_move(state, section, damper);
    return force_bank_current_mA(state, section, damper, demand_mN);
}

static const table_kind_t bank = {
    .name = "bank",
    .magic = FORCE_BANK_MAGIC,
    .least_words = SECTIONS_FIRST,
    .check = force_bank_check,
    .needs = force_bank_needs,
    .rate_Hz = force_bank_rate_Hz,
};

extern const track_t track_bank;
const track_t track_bank = {.name = "bank", .kind = &bank, .step = step};
