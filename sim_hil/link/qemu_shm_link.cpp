#include "qemu_shm_link.h"

namespace quiesce {

StartAnswer QemuShmLink::start(const quiesce_board_t *board, const quiesce_params_t &params,
                               const Tables &tables) {
    return image_.start(board, params, tables);
}

void QemuShmLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    image_.plain().stimulus = stimulus;
    image_.request(MAILBOX_STEP);
    reply = image_.plain().reply;
    if ((stimulus.flags & LOCKSTEP_PICTURE) == 0) {
        reply.picture = quiesce_picture_t{};
    }
}

} // namespace quiesce
