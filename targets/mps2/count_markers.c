// Brackets lockstep_exchange for the instruction counter of the bench: the linker sends every call
// of it (--wrap) through here. The count is what runs from quiesce_count_begin up to, not
// including, quiesce_count_end: the argument set-up, the call, and all of lockstep_exchange.
#include "lockstep.h"

void __real_lockstep_exchange(lockstep_t *server, const lockstep_stimulus_t *in,
                              lockstep_reply_t *out);
void __wrap_lockstep_exchange(lockstep_t *server, const lockstep_stimulus_t *in,
                              lockstep_reply_t *out);

void __wrap_lockstep_exchange(lockstep_t *server, const lockstep_stimulus_t *in,
                              lockstep_reply_t *out) {
    __asm__ volatile(".global quiesce_count_begin\nquiesce_count_begin:" ::: "memory");
    __real_lockstep_exchange(server, in, out);
    __asm__ volatile(".global quiesce_count_end\nquiesce_count_end:" ::: "memory");
}
