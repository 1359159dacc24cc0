// The peer of the sensing chain: a batch of 1024 points on CMSIS-DSP, real FFT, magnitudes, RMS.
// One of these parts is bracketed for the instruction counter; the batch runs as a whole, so that
// every part works on what the one before has made, and its results are printed beside the right
// ones.
#include "arm_math.h"

#include "counted_call.h"
#include "mailbox.h"
#include "print.h"
#include "test_signal.h"

#define POINTS 1024u
#define BINS (POINTS / 2u)
/// The input: so many cycles of a sine in the batch, noise 20 dB below it.
#define CYCLES 13u
#define AMPLITUDE 16000
#define NOISE 1960
/// arm_rms_q31 sums 1024 squares without saturation: its input needs five bits of headroom. (To
/// scale it down is not counted.)
#define Q31_HEADROOM 32
#define Q31_OF_Q15 65536

/// What the run is to be; the emulator puts it where the mailbox is otherwise.
typedef struct {
    uint32_t format; ///< 0 q15, 1 q31
    uint32_t part;   ///< which is counted: 0 FFT, 1 magnitudes, 2 RMS
} order_t;

enum { PART_FFT, PART_MAGNITUDE, PART_RMS };

static uint32_t part_counted;

static void call(uint32_t part, counted_function_t function, const void *a, const void *b,
                 uintptr_t c) {
    if (part == part_counted) {
        counted_call(function, (uintptr_t)a, (uintptr_t)b, c);
    } else {
        ((void (*)(uintptr_t, uintptr_t, uintptr_t))function)((uintptr_t)a, (uintptr_t)b, c);
    }
}

/// In q15 counts.
static void make_input(int16_t *samples) {
    uint32_t seed = 1;
    for (uint32_t i = 0; i < POINTS; i++) {
        samples[i] = (int16_t)(signal_sine(AMPLITUDE, 1000u * CYCLES, i, POINTS) +
                               signal_noise(&seed, NOISE));
    }
}

static uint32_t exact_rms(const int16_t *samples) {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        sum += (uint64_t)((int64_t)samples[i] * samples[i]);
    }
    const uint64_t mean = sum / POINTS;
    uint32_t root = 0;
    while ((uint64_t)(root + 1u) * (root + 1u) <= mean) {
        root++;
    }
    return root;
}

static bool run_q15(const int16_t *input) {
    static q15_t samples[POINTS], spectrum[2u * POINTS], magnitudes[BINS];
    static arm_rfft_instance_q15 fft;
    q15_t rms;
    uint32_t peak_bin = 0;

    if (arm_rfft_init_1024_q15(&fft, 0, 1) != ARM_MATH_SUCCESS) {
        return false;
    }
    for (uint32_t i = 0; i < POINTS; i++) {
        samples[i] = input[i];
    }
    call(PART_RMS, (counted_function_t)arm_rms_q15, samples, (const void *)POINTS, (uintptr_t)&rms);
    call(PART_FFT, (counted_function_t)arm_rfft_q15, &fft, samples, (uintptr_t)spectrum);
    call(PART_MAGNITUDE, (counted_function_t)arm_cmplx_mag_q15, spectrum, magnitudes, BINS);
    for (uint32_t i = 1; i < BINS; i++) {
        peak_bin = magnitudes[i] > magnitudes[peak_bin] ? i : peak_bin;
    }
    print("peak_bin", peak_bin);
    print("rms", (uint32_t)rms);
    return true;
}

static bool run_q31(const int16_t *input) {
    static q31_t samples[POINTS], scaled_down[POINTS], spectrum[2u * POINTS], magnitudes[BINS];
    static arm_rfft_instance_q31 fft;
    q31_t rms;
    uint32_t peak_bin = 0;

    if (arm_rfft_init_1024_q31(&fft, 0, 1) != ARM_MATH_SUCCESS) {
        return false;
    }
    for (uint32_t i = 0; i < POINTS; i++) {
        samples[i] = (q31_t)input[i] * Q31_OF_Q15;
        scaled_down[i] = samples[i] / Q31_HEADROOM;
    }
    call(PART_RMS, (counted_function_t)arm_rms_q31, scaled_down, (const void *)POINTS,
         (uintptr_t)&rms);
    call(PART_FFT, (counted_function_t)arm_rfft_q31, &fft, samples, (uintptr_t)spectrum);
    call(PART_MAGNITUDE, (counted_function_t)arm_cmplx_mag_q31, spectrum, magnitudes, BINS);
    for (uint32_t i = 1; i < BINS; i++) {
        peak_bin = magnitudes[i] > magnitudes[peak_bin] ? i : peak_bin;
    }
    print("peak_bin", peak_bin);
    print("rms", (uint32_t)(rms / (Q31_OF_Q15 / Q31_HEADROOM))); // in q15 counts, too
    return true;
}

int main(void) {
    static int16_t input[POINTS];
    const order_t order = *(const volatile order_t *)MAILBOX_BASE;

    part_counted = order.part;
    make_input(input);
    counted_call_init();
    if (!(order.format == 0 ? run_q15(input) : run_q31(input))) {
        return 1;
    }
    print("expected_bin", CYCLES);
    print("expected_rms", exact_rms(input));
    return counted_call_stack_bytes() < counted_call_stack_size_bytes() ? 0 : 1;
}
