#include "fault_store.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "clock.h"
#include "names.h"

namespace quiesced {

std::uint32_t FaultStore::load(std::string &note) {
    std::string why;
    note.clear();
    last_ = {};
    const nvm_verdict_t verdict = file_.read(&last_, why);
    const bool has_leftover =
        faccessat(AT_FDCWD, leftover().c_str(), F_OK, AT_SYMLINK_NOFOLLOW) == 0;
    if (verdict == NVM_OK && last_.fault != QUIESCE_FAULT_NONE) {
        note = std::string("fault ") + fault_name(last_.fault) + " of " + iso_time(last_.time_ns) +
               " is not acknowledged yet";
    } else if (verdict != NVM_OK && verdict != NVM_MISSING) {
        note = std::string("a fault is not acknowledged yet, its record cannot be read: ") + why;
    } else if (has_leftover) {
        note = "a fault is not acknowledged yet, the program was killed while it kept it: " +
               leftover();
    }
    if (!note.empty() && last_.fault == QUIESCE_FAULT_NONE) {
        last_ = {QUIESCE_FAULT_ESTOP, 0, realtime_ns()};
    }
    return last_.fault;
}

std::string FaultStore::keep(std::uint32_t fault) {
    const Record record = fault == last_.fault ? last_ : Record{fault, 0, realtime_ns()};
    std::string error = file_.write(&record);
    if (!error.empty()) {
        return error;
    }
    last_ = record;
    const bool is_gone = unlink(leftover().c_str()) == 0 || errno == ENOENT;
    return is_gone ? "" : leftover() + ": " + std::strerror(errno);
}

} // namespace quiesced
