// Prints a CRC-32 of all telemetry, so that builds and targets can be compared: the host's, a
// 32-bit one, one with sanitizers, the image.
//
//   same_bits          pseudo-random parameters and input, a line a case
//   same_bits COUNTS   32-bit little-endian counts at the default parameters (not on the image);
//                      the same number as quiesce_bench replay
#include "lockstep.h"

#include <stddef.h>

#include "put.h"
#include "test_signal.h"
#include "word_crc.h"

enum { CASES = 24, TICKS = 6000, SETTINGS = 6 };

typedef struct {
    uint32_t crc;
} digest_t;

// One stretch of a random run.
typedef struct {
    uint32_t left_ticks;
    uint32_t freq_mHz;
    int32_t amplitude;
    int32_t noise;
    int32_t offset;
    uint32_t dropouts; ///< in 1000 samples
} stretch_t;

static void append_telemetry(digest_t *self, const quiesce_telemetry_t *telemetry) {
    const uint32_t *words = (const uint32_t *)(const void *)telemetry;
    for (uint32_t i = 0; i < sizeof *telemetry / sizeof *words; i++) {
        self->crc = word_crc_append(self->crc, words[i]);
    }
}

// 0 .. count - 1, count <= 2^31
static uint32_t random_below(uint32_t *seed, uint32_t count) {
    const uint32_t draw = (uint32_t)signal_noise(seed, INT32_MAX) + INT32_MAX;
    return (uint32_t)((uint64_t)draw * count >> 32);
}

static int32_t random_value(uint32_t *seed, const quiesce_param_info_t *info) {
    if (info->choice_count > 0) {
        return info->choices[random_below(seed, info->choice_count)];
    }
    const int64_t span = (int64_t)info->max - info->min + 1;
    return (int32_t)(info->min + random_below(seed, INT32_MAX) % span);
}

// Some parameters anywhere in their ranges; those that contradict each other are drawn again.
static void draw_params(uint32_t *seed, uint32_t number, quiesce_params_t *params) {
    static const int32_t rates_Hz[] = {500, 1000, 2000, 4000};
    do {
        quiesce_params_default(params);
        for (uint32_t i = 0; number >= 16 && i < SETTINGS; i++) {
            const uint32_t index = random_below(seed, QUIESCE_PARAM_COUNT);
            quiesce_param_set(params, index, random_value(seed, quiesce_param_info(index)));
        }
        params->tick_rate_Hz = rates_Hz[number % 4u];
        params->law = (int32_t)(number / 4u % 4u);
    } while (!quiesce_params_check(params, NULL));
}

static stretch_t draw_stretch(uint32_t *seed) {
    const int32_t amplitude = 8388607 >> random_below(seed, 16);
    return (stretch_t){
        .left_ticks = 1u + random_below(seed, 6000),
        .freq_mHz = 500u + random_below(seed, 52000),
        .amplitude = amplitude,
        .noise = amplitude >> random_below(seed, 16),
        .offset = signal_noise(seed, 4000000) >> random_below(seed, 16),
        .dropouts = random_below(seed, 3) / 2u * random_below(seed, 300),
    };
}

static lockstep_stimulus_t draw_stimulus(uint32_t *seed, uint32_t tick, uint32_t rate_Hz,
                                         const stretch_t *stretch) {
    const int32_t tone = signal_sine(stretch->amplitude, stretch->freq_mHz, tick, rate_Hz);
    lockstep_stimulus_t in = {
        .counts = {tone + signal_noise(seed, stretch->noise) + stretch->offset},
        .current_meas_mA = {signal_noise(seed, 6000)},
    };
    in.flags = random_below(seed, 1000) >= stretch->dropouts ? LOCKSTEP_FRESH : 0u;
    in.flags |= tick > 0 && random_below(seed, 1000) != 0 ? LOCKSTEP_ENABLE : 0u;
    in.flags |= random_below(seed, 5000) == 0 ? LOCKSTEP_ESTOP : 0u;
    in.flags |= random_below(seed, 100) == 0 ? LOCKSTEP_FAULT_RESET : 0u;
    in.flags |= random_below(seed, 2) == 0 ? LOCKSTEP_HAS_CURRENT : 0u;
    in.flags |= LOCKSTEP_REPORT;
    return in;
}

static uint32_t run_case(lockstep_t *server, uint32_t number) {
    uint32_t seed = number + 1u;
    digest_t digest = {WORD_CRC_START};
    quiesce_params_t params;
    stretch_t stretch = {0};
    draw_params(&seed, number, &params);
    (void)lockstep_start(server, NULL, &params, NULL);
    for (uint32_t tick = 0; tick < TICKS; tick++, stretch.left_ticks--) {
        if (stretch.left_ticks == 0) {
            stretch = draw_stretch(&seed);
            server->in.tick += random_below(&seed, 4) == 0 ? 7u : 0u; // lost ticks
        }
        const lockstep_stimulus_t in =
            draw_stimulus(&seed, tick, (uint32_t)params.tick_rate_Hz, &stretch);
        lockstep_reply_t reply;
        lockstep_exchange(server, &in, &reply);
        append_telemetry(&digest, &reply.telemetry);
        for (uint32_t i = 0; i < QUIESCE_REPORT_WORDS; i++) {
            digest.crc = word_crc_append(digest.crc, (uint32_t)reply.report[i]);
        }
    }
    return ~digest.crc;
}

static int run_cases(lockstep_t *server) {
    for (uint32_t number = 0; number < CASES; number++) {
        put_hex(number);
        put_char(' ');
        put_hex(run_case(server, number));
        put_char('\n');
    }
    return 0;
}

#ifdef QUIESCE_TARGET_IMAGE
int main(void) {
    static lockstep_t server;
    return run_cases(&server);
}
#else
static bool read_count(FILE *file, int32_t *counts) {
    uint8_t bytes[4];
    if (fread(bytes, 1, sizeof bytes, file) != sizeof bytes) {
        return false;
    }
    *counts = (int32_t)(bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
                        (uint32_t)bytes[3] << 24);
    return true;
}

static int run_file(lockstep_t *server, const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        fprintf(stderr, "same_bits: %s: cannot be read\n", path);
        return 2;
    }
    digest_t digest = {WORD_CRC_START};
    quiesce_params_t params;
    quiesce_params_default(&params);
    (void)lockstep_start(server, NULL, &params, NULL);
    lockstep_stimulus_t in = {.flags = LOCKSTEP_FRESH}; // the edge of enable arms
    while (read_count(file, &in.counts[0])) {
        lockstep_reply_t reply;
        lockstep_exchange(server, &in, &reply);
        append_telemetry(&digest, &reply.telemetry);
        in.flags |= LOCKSTEP_ENABLE;
    }
    (void)fclose(file);
    put_hex(~digest.crc);
    put_char('\n');
    return 0;
}

int main(int argc, char **argv) {
    static lockstep_t server;
    return argc > 1 ? run_file(&server, argv[1]) : run_cases(&server);
}
#endif
