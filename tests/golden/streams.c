// Prints hashes of what the controller puts out on random streams, through its public header alone,
// so that it can be compiled against any commit's. ./tools/golden compares them with golden.txt.
#include "stream_cases.h"

int main(void) {
    static stream_t stream;
    record_print_columns();
    stream_random_cases(&stream);
    stream_table_cases(&stream);
    stream_rules_cases(&stream);
    stream_phase_cases(&stream);
    stream_storm_cases(&stream);
    return 0;
}
