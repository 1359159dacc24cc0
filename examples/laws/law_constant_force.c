// A law to start from: the same resisting force against every motion, like dry friction. The
// tracker finds the current; with tracker inverse and a damper's map no force is measured.
//
// To run it: copy this file into firmware/law/ and add "constant_force" to the labels of parameter
// law in firmware/param/parameters.toml, then run tools/gen/params.py.
#include "law.h"
#include "table.h"

// Its table is one number after the head of all tables.
enum { FORCE_mN = TABLE_HEAD_WORDS, MY_WORDS };

#define CONSTANT_FORCE_MAGIC UINT32_C(0x31464351)

static const uint32_t shipped[MY_WORDS] = {
    [TABLE_MAGIC] = CONSTANT_FORCE_MAGIC,
    [TABLE_CRC] = UINT32_C(0xB98CF628),
    [TABLE_WORDS] = MY_WORDS,
    [FORCE_mN] = 50000,
};

static quiesce_table_verdict_t check(const uint32_t *words) {
    if (words[TABLE_WORDS] != MY_WORDS) {
        return QUIESCE_TABLE_SIZE;
    }
    return words[FORCE_mN] <= VIEW_LIMIT ? QUIESCE_TABLE_OK : QUIESCE_TABLE_POINT;
}

static const table_kind_t force = {
    .name = "constant_force",
    .magic = CONSTANT_FORCE_MAGIC,
    .least_words = MY_WORDS,
    .shipped = shipped,
    .check = check,
};

// Against the motion, whichever way it goes; nothing at rest.
static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    (void)state;
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        out->value[i] = (int32_t)setup->table[FORCE_mN] * sign_i64(view->damper[i].velocity_um_s);
    }
    return true;
}

extern const law_t law_constant_force;
const law_t law_constant_force = {
    .name = "constant_force",
    .needs = VIEW_EACH(VIEW_STROKE_VELOCITY),
    .kind = &force,
    .demands = LAW_DEMANDS_FORCE,
    .step = step,
};
