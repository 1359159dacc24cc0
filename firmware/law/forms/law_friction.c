// Modulated homogeneous friction (Inaudi 1997): against the motion, in proportion to the last peak
// of the stroke, so that what is taken from a cycle grows with the square of it as in a linear
// damper. Stroke and its velocity are all that it needs.
//
// Its table, after the head of all tables: sections, one a damper from the first on: {gain in N/m,
// least peak in nm, limit in mN, band in um/s, ways}. A peak is the stroke's extreme since its
// velocity last changed its sign, found when that changes the sign again, beyond the band; below
// the least peak there is no demand. Bit 0 of ways: where the stroke grows away from 0, bit 1:
// where it comes back. `quiesce law make` writes them.
#include "fixq.h"
#include "law.h"
#include "sections.h"
#include "view_signal.h"

#define FRICTION_MAGIC UINT32_C(0x31524651)

enum { OUTWARD = 1, BACK = 2, um_PER_m = 1000000 };

typedef struct {
    int32_t gain_N_m;
    int32_t least_peak_nm;
    int32_t limit_mN;
    int32_t band_um_s;
    uint32_t ways;
} section_t;

enum { SECTION_WORDS = 5 };

_Static_assert(sizeof(section_t) == 4u * SECTION_WORDS, "words on the wire");

typedef struct {
    int32_t way; ///< of the stroke's velocity: -1 or 1; 0: not known yet
    int32_t extreme_nm;
    int32_t peak_nm; ///< magnitude
} peak_t;

_Static_assert(sizeof(peak_t) * QUIESCE_DAMPERS <= LAW_FORCE_STATE_BYTES, "the arena is too small");

static const section_t *section_of(const uint32_t *words, uint32_t i) {
    return (const section_t *)sections_first(words) + i;
}

static bool is_size(int32_t value) {
    return value >= 0 && value <= VIEW_LIMIT;
}

static uint32_t size(const uint32_t *words, uint32_t left) {
    (void)words;
    return left >= SECTION_WORDS ? SECTION_WORDS : 0;
}

static bool is_good(const uint32_t *words) {
    const section_t *section = (const section_t *)(const void *)words;
    return is_size(section->gain_N_m) && is_size(section->least_peak_nm) &&
           is_size(section->limit_mN) && is_size(section->band_um_s) && section->ways >= OUTWARD &&
           section->ways <= (OUTWARD | BACK);
}

static uint64_t needs(const uint32_t *words, uint32_t i) {
    (void)words;
    return (VIEW_STROKE | VIEW_STROKE_VELOCITY) << i;
}

static const sections_kind_t sections = {size, is_good, needs};

static quiesce_table_verdict_t check(const uint32_t *words) {
    return sections_check(&sections, words);
}

static uint64_t needs_of_table(const uint32_t *words) {
    return sections_need(&sections, words);
}

static void follow(peak_t *self, const section_t *section, const view_damper_t *damper) {
    const int32_t stroke_nm = damper->stroke_nm;
    const bool is_moving = abs_i32(damper->velocity_um_s) > section->band_um_s;
    const int32_t way = is_moving ? sign_i64(damper->velocity_um_s) : self->way;
    if (way != self->way) {
        self->peak_nm = abs_i32(self->way == 0 ? stroke_nm : self->extreme_nm);
        self->extreme_nm = stroke_nm;
        self->way = way;
    } else if ((way > 0 && stroke_nm > self->extreme_nm) ||
               (way < 0 && stroke_nm < self->extreme_nm)) {
        self->extreme_nm = stroke_nm;
    }
}

// gain (below 2^30) x peak (below 2^30) is below 2^60; floor.
static int32_t demand_mN(const peak_t *self, const section_t *section, int32_t stroke_nm) {
    const uint32_t now = (int64_t)stroke_nm * self->way > 0 ? OUTWARD : BACK;
    if (self->peak_nm < section->least_peak_nm || (section->ways & now) == 0) {
        return 0;
    }
    const int64_t force_mN = (int64_t)section->gain_N_m * self->peak_nm / um_PER_m;
    return (int32_t)clamp_i64(force_mN, 0, section->limit_mN) * self->way;
}

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    peak_t *self = state;
    law_demand_all(out, 0);
    for (uint32_t i = 0; i < sections_count(setup->table); i++) {
        const section_t *section = section_of(setup->table, i);
        const view_damper_t *damper = &view->damper[i];
        follow(&self[i], section, damper);
        out->value[i] = demand_mN(&self[i], section, damper->stroke_nm);
    }
    return true;
}

static const quiesce_word_t reports[QUIESCE_REPORT_WORDS] = {
    {"peak_1", "nm"},
    {"peak_2", "nm"},
    {"peak_3", "nm"},
    {"peak_4", "nm"},
};

static void report(const void *state, const law_setup_t *setup, int32_t word[]) {
    const peak_t *self = state;
    (void)setup;
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        word[i] = self[i].peak_nm;
    }
}

static const table_kind_t friction = {
    .name = "friction",
    .magic = FRICTION_MAGIC,
    .least_words = SECTIONS_FIRST,
    .check = check,
    .needs = needs_of_table,
};

extern const law_t law_friction;
const law_t law_friction = {
    .name = "friction",
    .kind = &friction,
    .demands = LAW_DEMANDS_FORCE,
    .reports = reports,
    .step = step,
    .report = report,
};
