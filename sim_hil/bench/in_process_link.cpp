#include "in_process_link.h"

namespace quiesce {

StartAnswer InProcessLink::start(const quiesce_board_t *board, const quiesce_params_t &params,
                                 const Tables &tables) {
    server_ = lockstep_t{};
    tables_ = tables;
    std::array<lockstep_table_t, LOCKSTEP_TABLES> used{};
    for (std::size_t i = 0; i < used.size(); ++i) {
        used[i] = {tables_[i].data(), static_cast<std::uint32_t>(tables_[i].size())};
    }
    const bool is_accepted = lockstep_start(&server_, board, &params, used.data());
    return {is_accepted, server_.refused};
}

void InProcessLink::visit_state(StateArchive &archive) {
    quiesce_t controller = server_.controller;
    archive(controller);
    archive(server_.in);
    archive(server_.out);
    if (archive.is_loading() && !quiesce_go_on(&server_.controller, &controller)) {
        throw InputError("a saved state of a controller with another law, tracker or table");
    }
}

void InProcessLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    lockstep_exchange(&server_, &stimulus, &reply);
    if ((stimulus.flags & LOCKSTEP_PICTURE) == 0) {
        reply.picture = quiesce_picture_t{};
    }
}

} // namespace quiesce
