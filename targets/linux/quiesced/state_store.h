/// Parameters saved over CAN, which outlive the program as a file of the state folder. All of it
/// blocks on the disk: never call it from the control loop.
#ifndef QUIESCED_STATE_STORE_H
#define QUIESCED_STATE_STORE_H

#include <string>

#include "firmware.h"

namespace quiesced {

class StateStore {
  public:
    explicit StateStore(const std::string &folder) : folder_(folder) {}

    /// The parameters that a start uses. Saved ones win as long as those of the configuration are
    /// the ones that they were saved over: who edits the configuration means it. *note says, in a
    /// line, what was decided; empty: nothing was saved.
    quiesce_params_t effective(const quiesce_params_t &configured, std::string &note) const;

    /// Returns why it failed; empty: saved.
    std::string save_params(const quiesce_params_t &configured, const quiesce_params_t &params);

    std::string params_file() const { return folder_ + "/parameters.bin"; }
    std::string status_file() const { return folder_ + "/state.json"; }

  private:
    std::string folder_;
};

} // namespace quiesced

#endif
