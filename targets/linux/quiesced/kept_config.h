/// The configuration that a controller runs with, kept in its state folder: whoever makes its
/// outputs safe after its death needs that one, not what has become of the file since.
#ifndef QUIESCED_KEPT_CONFIG_H
#define QUIESCED_KEPT_CONFIG_H

#include <optional>
#include <string>

#include "read_config.h"

namespace quiesced {

/// A configuration and the texts of its files.
struct ReadConfig {
    Config config;
    std::string text;
    std::string board_text; ///< "": it has no board
};

/// As require_config; the texts are those that were read.
ReadConfig require_config_text(const std::string &file);

/// Where the state is when the configuration cannot be read: systemd's STATE_DIRECTORY, or the
/// default.
std::string fallback_state_folder();

/// Blocks on the disk: never call it from the control loop.
class KeptConfig {
  public:
    explicit KeptConfig(const std::string &folder) : folder_(folder) {}

    /// Keeps the texts of the files (board_text "": there is none) and the parameters in effect.
    /// Returns why it failed, empty: kept; where it failed an earlier one is not kept either.
    std::string keep(const std::string &text, const std::string &board_text,
                     const quiesce_params_t &params);
    /// Keeps other parameters; likewise.
    std::string keep_params(const quiesce_params_t &params);

    /// Nothing where none is kept.
    std::optional<ConfigReading> load() const;
    /// The parameters that were in effect.
    std::optional<quiesce_params_t> load_params() const;

    std::string config_file() const { return folder_ + "/running.toml"; }
    std::string board_file() const { return folder_ + "/running.board.toml"; }
    std::string params_file() const { return folder_ + "/running.bin"; }

  private:
    std::string folder_;
};

} // namespace quiesced

#endif
