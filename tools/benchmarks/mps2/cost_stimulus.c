#include "cost_stimulus.h"

#include "test_signal.h"

/// Largest count of the ADC, and a vibration of about 1.2 m/s2 with the default scale.
#define FULL_SCALE_COUNTS 8388607
#define AMPLITUDE_COUNTS 20000
/// Uniform noise of this span has 0.0707 of the amplitude's RMS deviation: 20 dB.
#define NOISE_COUNTS 2449

typedef enum {
    CLEAN,
    SWEEP,   ///< frequency rises to four times its start
    DECAY,   ///< amplitude falls to nothing
    DROPS,   ///< single samples missing
    DROPOUT, ///< no sample in the middle third
    STUCK,   ///< the same sample from the middle on
    RANGE,   ///< bursts beyond the ADC's range
    GLITCH,  ///< single samples at full scale
    GAPS,    ///< tick numbers jump
} disturbance_t;

typedef struct {
    uint32_t time_ms;
    disturbance_t disturbance;
    int32_t amplitude_counts;
    int32_t noise_counts;
    uint32_t ratio_permille[COST_STIMULUS_TONES - 1u]; ///< of the other tones' frequencies; 0: none
} segment_t;

static const segment_t segments[] = {
    {3500, CLEAN, AMPLITUDE_COUNTS, NOISE_COUNTS, {0, 0}},
    {1000, CLEAN, AMPLITUDE_COUNTS, NOISE_COUNTS, {0, 0}},
    {500, CLEAN, AMPLITUDE_COUNTS, NOISE_COUNTS, {0, 0}},
    {3000, CLEAN, AMPLITUDE_COUNTS, NOISE_COUNTS, {1618, 2900}},
    {1500, DROPOUT, AMPLITUDE_COUNTS, NOISE_COUNTS, {0, 0}},
    {2000, CLEAN, AMPLITUDE_COUNTS, NOISE_COUNTS, {1370, 0}},
    {1500, CLEAN, 0, NOISE_COUNTS, {0, 0}},
    {2000, CLEAN, AMPLITUDE_COUNTS, NOISE_COUNTS, {3000, 5000}},
    {1600, STUCK, AMPLITUDE_COUNTS, NOISE_COUNTS, {0, 0}},
    {1500, GAPS, AMPLITUDE_COUNTS, NOISE_COUNTS, {0, 0}},
    {1500, RANGE, AMPLITUDE_COUNTS, NOISE_COUNTS, {0, 0}},
    {1000, CLEAN, 0, 1, {0, 0}},
    {1500, CLEAN, 8 * FULL_SCALE_COUNTS, 0, {0, 0}},
    {4000, SWEEP, AMPLITUDE_COUNTS, NOISE_COUNTS, {0, 0}},
    {1500, DROPS, AMPLITUDE_COUNTS, NOISE_COUNTS, {0, 0}},
    {2000, DECAY, 4 * AMPLITUDE_COUNTS, 100, {0, 0}},
    {1500, GLITCH, AMPLITUDE_COUNTS, NOISE_COUNTS, {0, 0}},
    {2000, CLEAN, FULL_SCALE_COUNTS / 3, NOISE_COUNTS, {1618, 2900}},
    {2000, CLEAN, AMPLITUDE_COUNTS, NOISE_COUNTS, {50, 0}},
    {1000, CLEAN, 0, 0, {0, 0}},
    {3000, CLEAN, AMPLITUDE_COUNTS, 2, {2100, 3300}},
};
#define SEGMENTS (sizeof segments / sizeof segments[0])

static uint32_t random_below(cost_stimulus_t *self, uint32_t limit) {
    return (uint32_t)(signal_noise(&self->seed, (int32_t)limit) + (int32_t)limit) / 2u % limit;
}

/// Spread evenly over five octaves, 1.5 to 48 Hz; over the lower three where there are more tones.
static uint32_t pick_freq_mHz(cost_stimulus_t *self, const segment_t *segment) {
    const uint32_t octaves = segment->ratio_permille[0] > 1000u ? 3u : 5u;
    const uint32_t octave = random_below(self, octaves);
    return (1500u << octave) + random_below(self, 1500u << octave);
}

static uint32_t increment_of(const cost_stimulus_t *self, uint32_t freq_mHz) {
    return (uint32_t)(((uint64_t)freq_mHz << 32) / (1000u * self->tick_rate_Hz));
}

static void begin_segment(cost_stimulus_t *self) {
    const segment_t *segment = &segments[self->segment];
    const uint32_t freq_mHz = pick_freq_mHz(self, segment);
    self->tick_in_segment = 0;
    self->segment_ticks = segment->time_ms * self->tick_rate_Hz / 1000u;
    self->tones[0].increment = increment_of(self, freq_mHz);
    self->tones[0].amplitude_counts = segment->amplitude_counts;
    for (uint32_t i = 1; i < COST_STIMULUS_TONES; i++) {
        const uint32_t ratio_permille = segment->ratio_permille[i - 1u];
        self->tones[i].increment = increment_of(self, freq_mHz * ratio_permille / 1000u);
        self->tones[i].amplitude_counts =
            ratio_permille == 0 ? 0 : segment->amplitude_counts * 2 / (int32_t)(2u + i);
    }
}

void cost_stimulus_init(cost_stimulus_t *self, uint32_t tick_rate_Hz) {
    *self = (cost_stimulus_t){.tick_rate_Hz = tick_rate_Hz, .seed = 1};
    begin_segment(self);
}

static int32_t clip(int64_t counts) {
    if (counts > FULL_SCALE_COUNTS) {
        return FULL_SCALE_COUNTS;
    }
    return counts < -FULL_SCALE_COUNTS ? -FULL_SCALE_COUNTS : (int32_t)counts;
}

/// The sine of a phase: 1 Hz at 2^24 ticks a second, at the phase's upper 24 bits.
static int32_t sine_at(int32_t amplitude, uint32_t phase) {
    return signal_sine(amplitude, 1000u, phase >> 8, 1u << 24);
}

static int32_t vibration(cost_stimulus_t *self) {
    int64_t counts = signal_noise(&self->seed, segments[self->segment].noise_counts);
    for (uint32_t i = 0; i < COST_STIMULUS_TONES; i++) {
        cost_tone_t *tone = &self->tones[i];
        if (tone->amplitude_counts != 0) {
            counts += sine_at(tone->amplitude_counts, tone->phase);
            tone->phase += tone->increment;
        }
    }
    return clip(counts);
}

/// Sweep and decay change the tones from tick to tick.
static void evolve(cost_stimulus_t *self) {
    const segment_t *segment = &segments[self->segment];
    cost_tone_t *tone = &self->tones[0];
    if (segment->disturbance == SWEEP && self->tick_in_segment == 0) {
        tone->increment = increment_of(self, 1500u + random_below(self, 10500u));
    } else if (segment->disturbance == SWEEP) {
        // Times e^(1.386/ticks): four times over the segment.
        tone->increment +=
            (uint32_t)((uint64_t)tone->increment * 1386u / (1000u * self->segment_ticks));
    } else if (segment->disturbance == DECAY) {
        const int64_t left = (int64_t)self->segment_ticks - self->tick_in_segment;
        tone->amplitude_counts = (int32_t)(segment->amplitude_counts * left * left /
                                           self->segment_ticks / self->segment_ticks);
    }
}

static void disturb(cost_stimulus_t *self, quiesce_in_t *in) {
    const uint32_t third = 3u * self->tick_in_segment / self->segment_ticks;
    switch (segments[self->segment].disturbance) {
    case DROPS:
        in->sensor[0].is_fresh = random_below(self, 20) != 0;
        break;
    case DROPOUT:
        in->sensor[0].is_fresh = third != 1u;
        break;
    case STUCK:
        self->held_counts = 2u * self->tick_in_segment < self->segment_ticks ? in->sensor[0].counts
                                                                             : self->held_counts;
        in->sensor[0].counts = self->held_counts;
        break;
    case RANGE:
        if (third == 1u) {
            in->sensor[0].counts = random_below(self, 2) == 0 ? INT32_MAX : INT32_MIN;
        }
        break;
    case GLITCH:
        in->sensor[0].counts =
            random_below(self, 50) == 0 ? FULL_SCALE_COUNTS : in->sensor[0].counts;
        break;
    case GAPS:
        self->tick += random_below(self, 150) == 0 ? 3u : 0u;
        in->tick = self->tick;
        break;
    case CLEAN:
    case SWEEP:
    case DECAY:
        break;
    }
}

void cost_stimulus_next(cost_stimulus_t *self, quiesce_in_t *in) {
    if (self->tick_in_segment == self->segment_ticks) {
        self->segment = (self->segment + 1u) % SEGMENTS;
        begin_segment(self);
    }
    evolve(self);
    *in = (quiesce_in_t){
        .tick = self->tick,
        .sensor[0].counts = vibration(self),
        .sensor[0].is_fresh = true,
        .enable = self->tick > 0, // its edge arms
    };
    disturb(self, in);
    self->tick++;
    self->tick_in_segment++;
}
