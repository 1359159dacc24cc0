/// The latched fault that outlives the program: a record in the state folder from the fault's entry
/// to its acknowledgement, in a file that has its room on the disk from the first start on. All of
/// it blocks on the disk: never call it from the control loop.
#ifndef QUIESCED_FAULT_STORE_H
#define QUIESCED_FAULT_STORE_H

#include <cstdint>
#include <string>

#include "firmware.h"

namespace quiesced {

class FaultStore {
  public:
    explicit FaultStore(const std::string &folder) : folder_(folder) {}
    FaultStore(const FaultStore &) = delete;
    FaultStore &operator=(const FaultStore &) = delete;
    ~FaultStore() { nvm_slots_close(&slots_); }

    /// The fault that an earlier run left, QUIESCE_FAULT_NONE: none. A record that cannot be read
    /// counts as an emergency stop, and so does leftover(). *note says what is kept, in a line;
    /// empty: nothing.
    std::uint32_t load(std::string &note);

    /// Keeps a fault, or forgets it (QUIESCE_FAULT_NONE). Returns why it failed; empty: done. At
    /// the start, with what load says: makes sure that there will be room for a fault and the right
    /// to write it.
    std::string keep(std::uint32_t fault);

    std::string file() const { return folder_ + "/fault.bin"; }
    /// Of a version that wrote its records aside: it was killed while it kept a fault.
    std::string leftover() const { return file() + ".new"; }

  private:
    struct Record {
        std::uint32_t fault;
        std::uint32_t reserved;
        std::int64_t time_ns; ///< CLOCK_REALTIME
    };

    std::string write(const Record &record);

    std::string folder_;
    nvm_slots_t slots_{-1, {}, 0, 0, 0};
    Record last_{}; ///< as loaded or kept
};

} // namespace quiesced

#endif
