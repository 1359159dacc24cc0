#include "record.h"

#include "put.h"
#include "word_crc.h"

// Every field by its name, in this order whatever the layout of the structure.
#define RECORD_FIELDS(X)                                                                           \
    X(out_current_cmd_mA, out->damper[0].current_cmd_mA)                                           \
    X(out_driver_enable, out->damper[0].driver_enable)                                             \
    X(tick, t->tick)                                                                               \
    X(state, t->state)                                                                             \
    X(fault, t->fault)                                                                             \
    X(fault_count, t->fault_count)                                                                 \
    X(bad_sample_count, t->bad_sample_count)                                                       \
    X(accel_um_s2, t->accel_um_s2)                                                                 \
    X(velocity_um_s, t->velocity_um_s)                                                             \
    X(rms_um_s2, t->rms_um_s2)                                                                     \
    X(freq_is_valid, t->freq_is_valid)                                                             \
    X(freq_age_ticks, t->freq_age_ticks)                                                           \
    X(freq_uHz, t->freq_uHz)                                                                       \
    X(freq_amp_um_s2, t->freq_amp_um_s2)                                                           \
    X(freq_phase_mdeg, t->freq_phase_mdeg)                                                         \
    X(freq_sigma_uHz, t->freq_sigma_uHz)                                                           \
    X(freq_window_ms, t->freq_window_ms)                                                           \
    X(displacement_nm, t->displacement_nm)                                                         \
    X(displacement_amp_nm, t->displacement_amp_nm)                                                 \
    X(velocity_rms_um_s, t->velocity_rms_um_s)                                                     \
    X(peak0_freq_uHz, t->peaks[0].freq_uHz)                                                        \
    X(peak0_amp_um_s2, t->peaks[0].amp_um_s2)                                                      \
    X(peak0_phase_mdeg, t->peaks[0].phase_mdeg)                                                    \
    X(peak1_freq_uHz, t->peaks[1].freq_uHz)                                                        \
    X(peak1_amp_um_s2, t->peaks[1].amp_um_s2)                                                      \
    X(peak1_phase_mdeg, t->peaks[1].phase_mdeg)                                                    \
    X(peak2_freq_uHz, t->peaks[2].freq_uHz)                                                        \
    X(peak2_amp_um_s2, t->peaks[2].amp_um_s2)                                                      \
    X(peak2_phase_mdeg, t->peaks[2].phase_mdeg)                                                    \
    X(rules_fired, word.rules_fired)                                                               \
    X(current_fuzzy_mA, word.current_fuzzy_mA)                                                     \
    X(current_law_mA, t->current_law_mA)                                                           \
    X(current_cmd_mA, t->current_cmd_mA)                                                           \
    X(lock_is_on, t->lock_is_on)                                                                   \
    X(adapt_state, word.adapt_state)                                                               \
    X(adapt_trials, word.adapt_trials)                                                             \
    X(adapt_gains, word.adapt_gains)                                                               \
    X(trim_on_mdeg, word.trim_on_mdeg)                                                             \
    X(trim_off_mdeg, word.trim_off_mdeg)                                                           \
    X(trim_level_q15, word.trim_level_q15)                                                         \
    X(trim_is_whole, word.trim_is_whole)

typedef struct {
    int32_t rules_fired, current_fuzzy_mA;
    int32_t adapt_state, adapt_trials, adapt_gains;
    int32_t trim_on_mdeg, trim_off_mdeg, trim_level_q15, trim_is_whole;
} law_words_t;

// As a law says them that has them, else as they were at rest.
static law_words_t law_words(const quiesce_t *controller, int32_t law) {
    int32_t w[QUIESCE_REPORT_WORDS];
    quiesce_report(controller, w);
    if (law == QUIESCE_LAW_PHASE) {
        return (law_words_t){0, 0, w[0], w[1], w[2], w[3], w[4], w[5], w[6]};
    }
    const bool has_rules = law == QUIESCE_LAW_FUZZY || law == QUIESCE_LAW_FUZZY_SELFTUNE;
    return (law_words_t){.current_fuzzy_mA = has_rules ? w[0] : 0,
                         .rules_fired = has_rules ? w[1] : 0,
                         .trim_level_q15 = 32768};
}

#define FIELD_NAME(name, value) #name,
#define FIELD_WORD(name, value) (uint32_t)(value),

static const char *const names[] = {RECORD_FIELDS(FIELD_NAME)};
// A new word of telemetry is hashed, too: it gets its line above.
_Static_assert(sizeof names / sizeof names[0] == RECORD_COLUMNS, "a field is missing or gone");

void record_print_columns(void) {
    put_text("columns");
    for (uint32_t i = 0; i < RECORD_COLUMNS; i++) {
        put_char(' ');
        put_text(names[i]);
    }
    put_char('\n');
}

static uint32_t append_text(record_t *self, uint32_t length, const char *text) {
    for (; *text != '\0' && length < RECORD_NAME_BYTES - sizeof "_00"; text++) {
        self->name[length++] = *text;
    }
    return length;
}

static void name_case(record_t *self, const char *group, const char *name, uint32_t number) {
    uint32_t length = append_text(self, 0, group);
    length = append_text(self, length, "/");
    length = append_text(self, length, name);
    self->name[length++] = '_';
    self->name[length++] = (char)('0' + number / 10u % 10u);
    self->name[length] = (char)('0' + number % 10u);
}

void record_start(record_t *self, const char *group, const char *name, uint32_t number) {
    *self = (record_t){0};
    name_case(self, group, name, number);
    for (uint32_t i = 0; i < RECORD_COLUMNS; i++) {
        self->columns[i] = WORD_CRC_START;
    }
    for (uint32_t i = 0; i < RECORD_MAX_BLOCKS; i++) {
        self->blocks[i] = WORD_CRC_START;
    }
}

void record_tick(record_t *self, const quiesce_t *controller, int32_t law,
                 const quiesce_out_t *out) {
    const quiesce_telemetry_t *t = &out->telemetry;
    const law_words_t word = law_words(controller, law);
    const uint32_t words[] = {RECORD_FIELDS(FIELD_WORD)};
    uint32_t *block = &self->blocks[self->ticks++ / RECORD_BLOCK_TICKS];
    for (uint32_t i = 0; i < RECORD_COLUMNS; i++) {
        *block = word_crc_append(*block, words[i]);
        self->columns[i] = word_crc_append(self->columns[i], words[i]);
    }
}

void record_words(record_t *self, const uint32_t *words, uint32_t count) {
    uint32_t *block = &self->blocks[self->ticks / RECORD_BLOCK_TICKS];
    for (uint32_t i = 0; i < count; i++) {
        *block = word_crc_append(*block, words[i]);
    }
}

void record_word(record_t *self, uint32_t word) {
    record_words(self, &word, 1);
}

static void print_words(const char *name, const char *kind, const uint32_t *words, uint32_t count) {
    put_text(name);
    put_char(' ');
    put_text(kind);
    for (uint32_t i = 0; i < count; i++) {
        put_char(' ');
        put_hex(words[i]);
    }
    put_char('\n');
}

void record_end(const record_t *self) {
    const uint32_t blocks = (self->ticks + RECORD_BLOCK_TICKS - 1u) / RECORD_BLOCK_TICKS;
    print_words(self->name, "out", self->blocks, blocks > 0 ? blocks : 1u);
    print_words(self->name, "col", self->columns, self->ticks > 0 ? RECORD_COLUMNS : 0);
}
