// Prints hashes as streams.c does, of the controller with the estimator fft: random vibrations at
// all rates, with the default parameters, then with random ones. `golden_fft
// >tests/golden/fft.txt`.
#include "stream_cases.h"

enum { FIRST_RANDOM = 20, STRIDE = 3, CASES = 12 };

int main(void) {
    static stream_t stream;
    record_print_columns();
    for (uint32_t i = 0; i < CASES; i++) {
        stream_open(&stream, "fft", i);
        do {
            stream_random_draw(&stream, i < CASES / 2 ? STRIDE * i : FIRST_RANDOM + STRIDE * i);
            stream.params.estimator = QUIESCE_ESTIMATOR_FFT;
        } while (!quiesce_params_check(&stream.params, NULL));
        stream_random_run(&stream);
    }
    return 0;
}
