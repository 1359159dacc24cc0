/// A vibration that depends on what the adaptation tries, for its tests: one instance a program.
#ifndef ADAPT_PLANT_H
#define ADAPT_PLANT_H

#include "adapt.h"

#include <stddef.h>

#include "test_signal.h"
#include "unity.h"

// A vibration of 20 ticks a half cycle whose reach and RMS acceleration depend on the trim, each
// least at a place of its own, and follow it by half of the rest a half cycle.

enum {
    HALF_TICKS = 20,
    SETTLE_TICKS = 200,
    MEASURE_TICKS = 100,
    TRIAL_TICKS = 2 * (SETTLE_TICKS + MEASURE_TICKS + 4 * HALF_TICKS + 60), // at most
    ROUND_TICKS = 3 * TRIAL_TICKS, // of the edges, and more than that
    WHOLE_ppm = 1000000,
    DEGREE_q16 = 364,
};

typedef struct {
    int32_t best[ADAPT_COORDINATES];
    int32_t rise_ppm[ADAPT_COORDINATES]; // a limit away from there
} bowl_t;

typedef struct {
    bowl_t reach;
    bowl_t rms;
    int32_t free_rms_ppm;   // RMS without current; 0: the trim's
    int32_t third_ppm;      // amplitude of the third harmonic, in antiphase, a limit of ON_EDGE on
    int32_t excitation_ppm; // of both
    int32_t drift_ppm;      // of that, a half cycle
    int32_t noise_ppm;      // of a half cycle
    int32_t now_reach_ppm;  // follows
    int32_t now_rms_ppm;
    int32_t now_third_ppm;
    uint32_t seed;
    uint32_t ticks;
    adapt_trim_t trim; // of this half cycle
} plant_t;

static const adapt_cfg_t cfg = {
    .start_ticks = 400,
    .settle_ticks = SETTLE_TICKS,
    .measure_ticks = MEASURE_TICKS,
    .rest_ticks = 3000,
    .edge_limit_q16 = 45 * DEGREE_q16,
    .level_limit_q15 = 16384,
};

static adapt_t adapt;
static adapt_in_t in;
static adapt_aim_t aim; // of every half cycle
static plant_t plant;
static uint32_t part_q16;

void setUp(void) {
    adapt_init(&adapt, &cfg);
    in = (adapt_in_t){.may_try = true, .freq_mHz = 10000};
    aim = (adapt_aim_t){.index = 3};
    part_q16 = 20000;
    plant = (plant_t){
        .excitation_ppm = WHOLE_ppm,
        .now_reach_ppm = WHOLE_ppm,
        .now_rms_ppm = WHOLE_ppm,
        .seed = 1,
    };
}
void tearDown(void) {}

static inline int32_t limit_of(uint32_t coordinate) {
    return coordinate == ADAPT_WHOLE   ? 1
           : coordinate == ADAPT_LEVEL ? cfg.level_limit_q15
                                       : cfg.edge_limit_q16;
}

static inline int32_t bowl_ppm(const bowl_t *bowl, const adapt_trim_t *trim) {
    int64_t sum = WHOLE_ppm;
    for (uint32_t i = 0; i < ADAPT_COORDINATES; i++) {
        const int64_t off = trim->value[i] - bowl->best[i];
        sum += bowl->rise_ppm[i] * off * off / ((int64_t)limit_of(i) * limit_of(i));
    }
    return (int32_t)sum;
}

// Half a cycle with these amplitudes: what harmonic_sums_take would have summed up.
static inline harmonic_sums_t half_of(int64_t first, int64_t third, int64_t rms) {
    return (harmonic_sums_t){
        .ticks = HALF_TICKS,
        .product = {first * HALF_TICKS * 16384, 0, third * HALF_TICKS * 16384, 0},
        .square = (uint64_t)(rms * rms * HALF_TICKS) >> HARMONICS_SQUARE_SHIFT,
    };
}

static inline harmonic_sums_t end_of_half(void) {
    const int32_t third_ppm =
        (int32_t)((int64_t)plant.third_ppm * plant.trim.value[ADAPT_ON_EDGE] / cfg.edge_limit_q16);
    plant.now_reach_ppm += (bowl_ppm(&plant.reach, &plant.trim) - plant.now_reach_ppm) / 2;
    const bool is_free = plant.trim.value[ADAPT_LEVEL] == ADAPT_NO_CURRENT;
    const int32_t rms_ppm =
        is_free && plant.free_rms_ppm != 0 ? plant.free_rms_ppm : bowl_ppm(&plant.rms, &plant.trim);
    plant.now_rms_ppm += (rms_ppm - plant.now_rms_ppm) / 2;
    plant.now_third_ppm += (third_ppm - plant.now_third_ppm) / 2;
    plant.excitation_ppm += plant.drift_ppm;
    const int64_t noise_ppm = WHOLE_ppm + signal_noise(&plant.seed, plant.noise_ppm);
    const int64_t scale_ppm = plant.excitation_ppm * noise_ppm / WHOLE_ppm;
    return half_of(plant.now_reach_ppm * scale_ppm / WHOLE_ppm,
                   plant.now_third_ppm * scale_ppm / WHOLE_ppm,
                   plant.now_rms_ppm * scale_ppm / WHOLE_ppm);
}

static inline void step(void) {
    adapt_aim(&adapt, &aim);
    adapt_step(&adapt, &in);
}

static inline void tick(void) {
    plant.ticks++;
    if (plant.ticks % HALF_TICKS == 0) {
        const harmonic_sums_t half = end_of_half();
        in.half = &half;
        step();
        plant.trim = adapt_trim_at(&adapt, aim.index, part_q16);
    } else {
        in.half = NULL;
        step();
    }
}

static inline void run(uint32_t ticks) {
    for (; ticks > 0; ticks--) {
        tick();
    }
}

static inline bool run_until(adapt_state_t state, uint32_t most_ticks) {
    for (; adapt.state != state && most_ticks > 0; most_ticks--) {
        tick();
    }
    return adapt.state == state;
}

static inline const adapt_trim_t *learnt(void) {
    return &adapt.trim[aim.index];
}

static inline void assert_nothing_learnt(void) {
    TEST_ASSERT_EQUAL_UINT32(0, adapt.gains);
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        for (uint32_t k = 0; k < ADAPT_COORDINATES; k++) {
            TEST_ASSERT_EQUAL_INT16(0, adapt.trim[i].value[k]);
        }
    }
}

#endif
