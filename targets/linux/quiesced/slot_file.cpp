#include "slot_file.h"

#include <cerrno>
#include <cstring>

namespace quiesced {

nvm_verdict_t SlotFile::read(void *data, std::string &why) const {
    linux_error_t error{};
    const nvm_verdict_t verdict = nvm_slots_read(path_.c_str(), kind_, data, bytes_, &error);
    why = error.text;
    return verdict;
}

std::string SlotFile::write(const void *data) {
    linux_error_t error{};
    if (!nvm_slots_are_at(&slots_, path_.c_str())) {
        nvm_slots_close(&slots_);
        if (!nvm_slots_open(&slots_, path_.c_str(), kind_, data, bytes_, &error)) {
            return error.text;
        }
    }
    return nvm_slots_write(&slots_, data) ? "" : path_ + ": " + std::strerror(errno);
}

} // namespace quiesced
