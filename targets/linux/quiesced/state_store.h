/// What outlives the program, as files of the state folder: parameters saved over CAN and what the
/// law has learnt. All of it blocks on the disk: never call it from the control loop.
#ifndef QUIESCED_STATE_STORE_H
#define QUIESCED_STATE_STORE_H

#include <optional>
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

    /// Nothing where there is none; *note says why where it is damaged.
    std::optional<quiesce_learnt_t> load_learnt(std::string &note) const;
    std::string save_learnt(const quiesce_learnt_t &learnt);

    std::string params_file() const { return folder_ + "/parameters.bin"; }
    std::string learnt_file() const { return folder_ + "/learnt.bin"; }
    std::string status_file() const { return folder_ + "/state.json"; }

  private:
    std::string folder_;
};

} // namespace quiesced

#endif
