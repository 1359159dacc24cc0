// Prints hashes of what the guarding blocks say on random inputs; guards.txt has them recorded.
#include "part_cases.h"

int main(void) {
    part_current_cases();
    part_stop_cases();
    part_frame_cases();
    return 0;
}
