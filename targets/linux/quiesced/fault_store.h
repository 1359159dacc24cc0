/// The latched fault that outlives the program: a record in the state folder from the fault's entry
/// to its acknowledgement, in a file that has its room on the disk from the first start on. All of
/// it blocks on the disk: never call it from the control loop.
#ifndef QUIESCED_FAULT_STORE_H
#define QUIESCED_FAULT_STORE_H

#include <cstdint>
#include <string>

#include "slot_file.h"

namespace quiesced {

class FaultStore {
  public:
    explicit FaultStore(const std::string &folder)
        : file_(folder + "/fault.bin", "fault", sizeof(Record)) {}

    /// The fault that an earlier run left, QUIESCE_FAULT_NONE: none. A record that cannot be read
    /// counts as an emergency stop, and so does leftover(). *note says what is kept, in a line;
    /// empty: nothing.
    std::uint32_t load(std::string &note);

    /// Keeps a fault, or forgets it (QUIESCE_FAULT_NONE). Returns why it failed; empty: done. At
    /// the start, with what load says: makes sure that there will be room for a fault and the right
    /// to write it.
    std::string keep(std::uint32_t fault);

    const std::string &file() const { return file_.path(); }
    /// Of a version that wrote its records aside: it was killed while it kept a fault.
    std::string leftover() const { return file() + ".new"; }

  private:
    struct Record {
        std::uint32_t fault;
        std::uint32_t reserved;
        std::int64_t time_ns; ///< CLOCK_REALTIME
    };

    SlotFile file_;
    Record last_{}; ///< as loaded or kept
};

} // namespace quiesced

#endif
