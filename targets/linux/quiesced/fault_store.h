/// The latched fault that outlives the program: a record in the state folder from the fault's entry
/// to its acknowledgement. All of it blocks on the disk: never call it from the control loop.
#ifndef QUIESCED_FAULT_STORE_H
#define QUIESCED_FAULT_STORE_H

#include <cstdint>
#include <string>

namespace quiesced {

class FaultStore {
  public:
    explicit FaultStore(const std::string &folder) : folder_(folder) {}

    /// The fault that an earlier run left, QUIESCE_FAULT_NONE: none. A record that cannot be read
    /// counts as an emergency stop. *note says what is kept, in a line; empty: nothing.
    std::uint32_t load(std::string &note) const;

    /// Keeps a fault, or forgets it (QUIESCE_FAULT_NONE). Returns why it failed; empty: done.
    std::string keep(std::uint32_t fault);

    std::string file() const { return folder_ + "/fault.bin"; }

  private:
    std::string folder_;
};

} // namespace quiesced

#endif
