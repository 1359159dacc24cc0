#include "state_store.h"

namespace quiesced {

namespace {

constexpr const char *kParamKind = "param";
constexpr std::uint32_t kVersion = QUIESCE_PARAM_LAYOUT; // of another release: not used

/// On the disk: of another number of parameters is of another length, and damaged.
struct SavedParams {
    std::uint32_t configured_hash; ///< of the configuration's parameters at the time
    quiesce_params_t params;
};

} // namespace

quiesce_params_t StateStore::effective(const quiesce_params_t &configured,
                                       std::string &note) const {
    SavedParams saved{};
    linux_error_t error{};
    note.clear();
    switch (
        nvm_file_read(params_file().c_str(), kParamKind, kVersion, &saved, sizeof saved, &error)) {
    case NVM_MISSING:
        return configured;
    case NVM_OK:
        break;
    default:
        note = std::string("saved parameters are not used: ") + error.text;
        return configured;
    }
    if (saved.configured_hash != can_node_param_hash(&configured)) {
        note = "saved parameters are not used: [parameters] has changed since";
        return configured;
    }
    quiesce_param_error_t refused{};
    if (!quiesce_params_check(&saved.params, &refused)) {
        note = std::string("saved parameters are not used: ") +
               quiesce_param_info(refused.index)->name + ": " + refused.reason;
        return configured;
    }
    note = "saved parameters are used";
    return saved.params;
}

std::string StateStore::save_params(const quiesce_params_t &configured,
                                    const quiesce_params_t &params) {
    const SavedParams saved = {can_node_param_hash(&configured), params};
    linux_error_t error{};
    return nvm_file_write(params_file().c_str(), kParamKind, kVersion, &saved, sizeof saved, &error)
               ? ""
               : error.text;
}

} // namespace quiesced
