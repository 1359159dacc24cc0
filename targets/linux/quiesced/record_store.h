/// The fault record (fault_record.h) that outlives the program, in the state folder. All of it
/// blocks on the disk: never call it from the control loop.
#ifndef QUIESCED_RECORD_STORE_H
#define QUIESCED_RECORD_STORE_H

#include <array>
#include <cstdint>
#include <string>

#include "slot_file.h"

namespace quiesced {

/// As on the disk.
struct KeptRecord {
    std::uint32_t is_held;
    std::uint32_t is_acknowledged;
    std::array<std::uint32_t, FAULT_RECORD_WORDS> words; ///< 0 where none is held
};

class RecordStore {
  public:
    explicit RecordStore(const std::string &folder)
        : file_(folder + "/record.bin", "record", sizeof(KeptRecord)) {}

    /// What an earlier run left; none is held where it cannot be read, and *note says why.
    KeptRecord load(std::string &note) const;

    /// Returns why it failed; empty: kept. At the start, with what load says: makes sure that there
    /// will be room for a record.
    std::string keep(const KeptRecord &record) { return file_.write(&record); }

    const std::string &file() const { return file_.path(); }

  private:
    SlotFile file_;
};

} // namespace quiesced

#endif
