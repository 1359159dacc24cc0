/// A record of a fixed size that outlives the program, in a file that has its room on the disk from
/// the first write on. All of it blocks on the disk: never call it from the control loop.
#ifndef QUIESCED_SLOT_FILE_H
#define QUIESCED_SLOT_FILE_H

#include <string>

#include "firmware.h"

namespace quiesced {

class SlotFile {
  public:
    SlotFile(std::string path, const char *kind, std::size_t bytes)
        : path_(std::move(path)), kind_(kind), bytes_(bytes) {}
    SlotFile(const SlotFile &) = delete;
    SlotFile &operator=(const SlotFile &) = delete;
    ~SlotFile() { nvm_slots_close(&slots_); }

    const std::string &path() const { return path_; }

    /// *why: where it is neither NVM_OK nor NVM_MISSING.
    nvm_verdict_t read(void *data, std::string &why) const;

    /// Makes the file where it is missing, removed or damaged. Returns why it failed; empty: done.
    std::string write(const void *data);

  private:
    std::string path_;
    const char *kind_;
    std::size_t bytes_;
    nvm_slots_t slots_{-1, {}, 0, 0, 0};
};

} // namespace quiesced

#endif
