// libFuzzer: any parameters, any samples. Whatever arrives, nothing is undefined (the sanitizers
// watch) and every output keeps the bounds that quiesce.h and the parameters state.
//
// The input is a list: parameters first, then stretches of ticks, each with its signal and inputs.
#include "quiesce.h"

#include "fuzz_bytes.h"
#include "test_signal.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

enum {
    MAX_TICKS = 6000, // an input; several of the longest windows
    MAX_SETTINGS = 12,
    ACCEL_LIMIT_um_s2 = 500000000,
    AMP_LIMIT_um_s2 = 1 << 30,
    SHORTEST_WINDOW_ms = 128,
    LONGEST_WINDOW_ms = 1024,
    MOVE_TICKS = 7, // between copies of the state, where the input asks for them
};

// One stretch of equal ticks.
typedef struct {
    uint32_t kind;
    uint32_t flags;
    uint32_t ticks;
    int32_t amplitude;
    int32_t offset;
    uint32_t freq_mHz;
    int32_t noise;
} stretch_t;

enum { KIND_TONE, KIND_HARMONICS, KIND_CONSTANT, KIND_NOISE, KIND_RAILS, KIND_BYTES, KINDS };

enum {
    FLAG_ENABLE = 1,
    FLAG_ESTOP = 2,
    FLAG_RESET = 4,
    FLAG_CURRENT = 8,
    FLAG_DROPOUTS = 16,
    FLAG_GAP = 32,
    FLAG_MOVE = 64,
    FLAG_RESTART = 128,
};

typedef struct {
    bytes_t input;
    quiesce_params_t params;
    bool is_accepted;
    quiesce_t *controller;
    quiesce_out_t last;
    uint32_t tick;
    uint32_t ticks_left;
    uint32_t seed;
} fuzz_t;

static int32_t take_counts(bytes_t *bytes) {
    return (int32_t)(take(bytes, 3) << 8) >> 8;
}

static int32_t choose_value(const quiesce_param_info_t *info, uint32_t mode, uint32_t raw) {
    switch (mode % 8u) {
    case 0:
        return info->min;
    case 1:
        return info->max;
    case 2:
        return (int32_t)raw; // most of these are refused
    default:
        if (info->choices != NULL) {
            return info->choices[raw % info->choice_count];
        }
        return (int32_t)(info->min + raw % ((int64_t)info->max - info->min + 1));
    }
}

static void read_params(fuzz_t *fuzz) {
    quiesce_params_default(&fuzz->params);
    const uint32_t settings = take(&fuzz->input, 1) % (MAX_SETTINGS + 1);
    for (uint32_t i = 0; i < settings; i++) {
        const uint32_t index = take(&fuzz->input, 1) % QUIESCE_PARAM_COUNT;
        const uint32_t mode = take(&fuzz->input, 1);
        const uint32_t raw = take(&fuzz->input, 4);
        const int32_t value = choose_value(quiesce_param_info(index), mode, raw);
        REQUIRE(quiesce_param_set(&fuzz->params, index, value));
    }
    quiesce_param_error_t error;
    fuzz->is_accepted = quiesce_params_check(&fuzz->params, &error);
    REQUIRE(fuzz->is_accepted || error.index < QUIESCE_PARAM_COUNT);
}

static stretch_t read_stretch(bytes_t *input) {
    const uint32_t first = take(input, 1);
    const uint32_t repeat = take(input, 1);
    stretch_t stretch = {
        .kind = first % KINDS,
        .flags = take(input, 1),
        .ticks = (repeat + 1u) << (first >> 6) * 2u,
        .amplitude = (int32_t)take(input, 3),
        .freq_mHz = 2u * take(input, 2),
    };
    stretch.offset = take_counts(input);
    stretch.noise = stretch.amplitude >> take(input, 1) % 25u;
    return stretch;
}

static int32_t counts_at(fuzz_t *fuzz, const stretch_t *stretch) {
    const uint32_t rate_Hz = fuzz->is_accepted ? (uint32_t)fuzz->params.tick_rate_Hz : 1000u;
    int64_t counts = stretch->offset;
    switch (stretch->kind) {
    case KIND_HARMONICS:
        counts += signal_sine(stretch->amplitude / 2, 3u * stretch->freq_mHz, fuzz->tick, rate_Hz);
        // fall through
    case KIND_TONE:
        counts += signal_sine(stretch->amplitude, stretch->freq_mHz, fuzz->tick, rate_Hz);
        counts += signal_noise(&fuzz->seed, stretch->noise);
        break;
    case KIND_NOISE:
        counts += signal_noise(&fuzz->seed, stretch->amplitude);
        break;
    case KIND_RAILS:
        counts += fuzz->tick & 1u ? stretch->amplitude : -stretch->amplitude;
        break;
    case KIND_BYTES:
        return (int32_t)take(&fuzz->input, 4);
    default:
        break;
    }
    return (int32_t)counts;
}

static bool is_faulted(uint32_t state) {
    return state == QUIESCE_STATE_SAFE || state == QUIESCE_STATE_FAULT;
}

// SAFE keeps what was before; without a test there is no driver, nor in a latched fault.
static bool is_enabled(const fuzz_t *fuzz, uint32_t state) {
    switch (state) {
    case QUIESCE_STATE_SAFE:
        return fuzz->last.damper[0].driver_enable;
    case QUIESCE_STATE_INIT:
    case QUIESCE_STATE_SELF_TEST:
    case QUIESCE_STATE_FAULT:
        return false;
    default:
        return true;
    }
}

static bool is_driven(uint32_t state) {
    return state == QUIESCE_STATE_RUN || state == QUIESCE_STATE_DEGRADED;
}

static void check_output(const fuzz_t *fuzz, const quiesce_out_t *out) {
    const quiesce_telemetry_t *t = &out->telemetry;
    const int32_t safe_mA = quiesce_params_safe_current_mA(&fuzz->params);
    REQUIRE(t->tick == fuzz->tick);
    REQUIRE(t->state < QUIESCE_STATE_COUNT && t->fault < QUIESCE_FAULT_COUNT);
    REQUIRE(is_faulted(t->state) == (t->fault != QUIESCE_FAULT_NONE));
    REQUIRE(out->damper[0].current_cmd_mA == t->current_cmd_mA);
    if (is_driven(t->state)) {
        REQUIRE(out->damper[0].current_cmd_mA >= 0 &&
                out->damper[0].current_cmd_mA <= fuzz->params.max_current_mA);
    } else {
        REQUIRE(out->damper[0].current_cmd_mA == safe_mA);
    }
    REQUIRE(out->damper[0].driver_enable == is_enabled(fuzz, t->state));
    if (!fuzz->is_accepted) {
        REQUIRE(t->state == QUIESCE_STATE_FAULT && t->fault == QUIESCE_FAULT_PARAMETER);
    }
}

static void check_order(const quiesce_telemetry_t *t, const quiesce_telemetry_t *last) {
    REQUIRE(t->fault_count - last->fault_count <= 1u);
    REQUIRE(t->bad_sample_count - last->bad_sample_count <= 1u);
    REQUIRE(t->freq_age_ticks == 0u || t->freq_age_ticks - 1u <= last->freq_age_ticks);
}

static bool is_in(int32_t value, int32_t low, int32_t high) {
    return value >= low && value <= high;
}

static void check_component(const fuzz_t *fuzz, const quiesce_peak_t *peak) {
    quiesce_params_t defaults;
    quiesce_params_default(&defaults);
    const quiesce_params_t *params = fuzz->is_accepted ? &fuzz->params : &defaults;
    REQUIRE(peak->freq_uHz == 0 ||
            is_in(peak->freq_uHz, params->band_low_mHz * 1000, params->band_high_mHz * 1000));
    REQUIRE(is_in(peak->amp_um_s2, 0, AMP_LIMIT_um_s2));
    REQUIRE(is_in(peak->phase_mdeg, -180000, 179999));
}

static void check_signals(const fuzz_t *fuzz, const quiesce_telemetry_t *t) {
    const quiesce_peak_t dominant = {t->freq_uHz, t->freq_amp_um_s2, t->freq_phase_mdeg};
    REQUIRE(is_in(t->accel_um_s2, -ACCEL_LIMIT_um_s2, ACCEL_LIMIT_um_s2));
    REQUIRE(is_in(t->velocity_um_s, -(1 << 30), 1 << 30));
    REQUIRE(is_in(t->rms_um_s2, 0, ACCEL_LIMIT_um_s2));
    REQUIRE(t->freq_is_valid <= 1u);
    REQUIRE(t->freq_is_valid == 0u || (t->freq_uHz > 0 && t->freq_age_ticks == 0u));
    REQUIRE(t->freq_sigma_uHz >= 0 && t->freq_window_ms <= LONGEST_WINDOW_ms);
    REQUIRE(t->freq_is_valid == 0u || t->freq_window_ms >= SHORTEST_WINDOW_ms);
    REQUIRE(t->displacement_amp_nm >= 0 && t->velocity_rms_um_s >= 0);
    REQUIRE(t->displacement_nm != INT32_MIN);
    REQUIRE(t->current_law_mA >= 0);
    check_component(fuzz, &dominant);
    for (uint32_t i = 0; i < QUIESCE_PEAKS; i++) {
        check_component(fuzz, &t->peaks[i]);
    }
}

// Words without a name are 0; rules and their current stay in their ranges.
static void check_report(const fuzz_t *fuzz) {
    const int32_t law = fuzz->is_accepted ? fuzz->params.law : QUIESCE_LAW_FUZZY;
    const quiesce_word_t *names = quiesce_report_words(law);
    int32_t word[QUIESCE_REPORT_WORDS];
    memset(word, 0xA5, sizeof word);
    quiesce_report(fuzz->controller, word);
    for (uint32_t i = 0; i < QUIESCE_REPORT_WORDS; i++) {
        REQUIRE(names[i].name != NULL || word[i] == 0);
    }
    if (law == QUIESCE_LAW_FUZZY || law == QUIESCE_LAW_FUZZY_SELFTUNE) {
        REQUIRE(word[0] >= 0 && (uint32_t)word[1] < UINT32_C(1) << 16);
    }
}

static void step(fuzz_t *fuzz, const stretch_t *stretch) {
    const quiesce_in_t in = {
        .tick = fuzz->tick,
        .sensor[0].counts = counts_at(fuzz, stretch),
        .driver[0].current_mA =
            fuzz->last.damper[0].current_cmd_mA + signal_noise(&fuzz->seed, stretch->noise),
        .sensor[0].is_fresh =
            (stretch->flags & FLAG_DROPOUTS) == 0 || signal_noise(&fuzz->seed, 1000) > 0,
        .driver[0].is_measured = (stretch->flags & FLAG_CURRENT) != 0,
        .enable = (stretch->flags & FLAG_ENABLE) != 0,
        .estop = (stretch->flags & FLAG_ESTOP) != 0,
        .fault_reset = (stretch->flags & FLAG_RESET) != 0,
    };
    quiesce_out_t out;
    memset(&out, 0xA5, sizeof out); // every word must be written
    quiesce_step(fuzz->controller, &in, &out);
    check_output(fuzz, &out);
    check_signals(fuzz, &out.telemetry);
    check_report(fuzz);
    check_order(&out.telemetry, &fuzz->last.telemetry);
    fuzz->last = out;
    fuzz->tick++;
}

// A copy of the state is the controller; the old one may be overwritten.
static void move(fuzz_t *fuzz) {
    quiesce_t *copy = malloc(sizeof *copy);
    REQUIRE(copy != NULL);
    *copy = *fuzz->controller;
    memset(fuzz->controller, 0xA5, sizeof *fuzz->controller);
    free(fuzz->controller);
    fuzz->controller = copy;
}

static void start(fuzz_t *fuzz) {
    fuzz->last = (quiesce_out_t){0};
    fuzz->last.telemetry.fault_count = fuzz->is_accepted ? 0u : 1u;
    fuzz->last.telemetry.freq_age_ticks = UINT32_MAX; // never valid so far
    REQUIRE(quiesce_init(fuzz->controller, &fuzz->params) == fuzz->is_accepted);
}

static void run(fuzz_t *fuzz, stretch_t stretch) {
    if (stretch.flags & FLAG_RESTART) {
        start(fuzz);
    }
    if (stretch.flags & FLAG_GAP) {
        fuzz->tick += stretch.freq_mHz;
    }
    const uint32_t ticks = stretch.ticks < fuzz->ticks_left ? stretch.ticks : fuzz->ticks_left;
    for (uint32_t i = 0; i < ticks; i++) {
        if ((stretch.flags & FLAG_MOVE) != 0 && i % MOVE_TICKS == 0) {
            move(fuzz);
        }
        step(fuzz, &stretch);
    }
    fuzz->ticks_left -= ticks;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    fuzz_t fuzz = {.input = {bytes, count}, .ticks_left = MAX_TICKS, .seed = 1};
    read_params(&fuzz);
    fuzz.controller = malloc(sizeof *fuzz.controller);
    REQUIRE(fuzz.controller != NULL);
    memset(fuzz.controller, 0xA5, sizeof *fuzz.controller); // init must not need zeros
    start(&fuzz);
    while (fuzz.input.left > 0 && fuzz.ticks_left > 0) {
        run(&fuzz, read_stretch(&fuzz.input));
    }
    free(fuzz.controller);
    return 0;
}
