#include "fault_store.h"

#include <cerrno>
#include <cstring>

#include <unistd.h>

#include "clock.h"
#include "firmware.h"
#include "names.h"

namespace quiesced {

namespace {

constexpr const char *kKind = "fault";
constexpr std::uint32_t kVersion = 1;

struct Record {
    std::uint32_t fault;
    std::uint32_t reserved;
    std::int64_t time_ns; ///< CLOCK_REALTIME
};

} // namespace

std::uint32_t FaultStore::load(std::string &note) const {
    Record record{};
    linux_error_t error{};
    note.clear();
    switch (nvm_file_read(file().c_str(), kKind, kVersion, &record, sizeof record, &error)) {
    case NVM_MISSING:
        return QUIESCE_FAULT_NONE;
    case NVM_OK:
        if (record.fault != QUIESCE_FAULT_NONE) {
            note = std::string("fault ") + fault_name(record.fault) + " of " +
                   iso_time(record.time_ns) + " is not acknowledged yet";
        }
        return record.fault;
    default:
        note = std::string("a fault is not acknowledged yet, its record cannot be read: ") +
               error.text;
        return QUIESCE_FAULT_ESTOP;
    }
}

std::string FaultStore::keep(std::uint32_t fault) {
    if (fault == QUIESCE_FAULT_NONE) {
        const bool is_gone = unlink(file().c_str()) == 0 || errno == ENOENT;
        return is_gone ? "" : file() + ": " + std::strerror(errno);
    }
    const Record record = {fault, 0, realtime_ns()};
    linux_error_t error{};
    return nvm_file_write(file().c_str(), kKind, kVersion, &record, sizeof record, &error)
               ? ""
               : error.text;
}

} // namespace quiesced
