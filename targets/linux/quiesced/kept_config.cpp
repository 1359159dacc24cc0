#include "kept_config.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <unistd.h>

#include "input_error.h"
#include "status_file.h"

namespace quiesced {

namespace {

constexpr const char *kParamKind = "running";
constexpr std::uint32_t kVersion = 1;
constexpr int kReadings = 3;

std::string text_of(const std::string &file) {
    std::ostringstream out;
    out << std::ifstream(file).rdbuf();
    return out.str();
}

} // namespace

ReadConfig require_config_text(const std::string &file) {
    for (int i = 0; i < kReadings; ++i) {
        std::string text = text_of(file);
        Config config = require_config(file, Needs::peripherals);
        if (text_of(file) == text) {
            return {std::move(config), std::move(text)};
        }
    }
    throw quiesce::InputError(file + ": changes while it is read; try again");
}

std::string fallback_state_folder() {
    const char *given = std::getenv("STATE_DIRECTORY");
    std::string folder = given == nullptr ? "" : given;
    folder = folder.substr(0, folder.find(':')); // systemd lists all of them
    return folder.rfind('/', 0) == 0 ? folder : StateConfig().folder;
}

std::string KeptConfig::keep(const std::string &text, const quiesce_params_t &params) {
    // Parameters of an earlier configuration do not belong to this one.
    (void)unlink(params_file().c_str());
    std::string error = replace_file(config_file(), text);
    if (!error.empty()) {
        (void)unlink(config_file().c_str());
        return error;
    }
    return keep_params(params);
}

std::string KeptConfig::keep_params(const quiesce_params_t &params) {
    linux_error_t error{};
    if (nvm_file_write(params_file().c_str(), kParamKind, kVersion, &params, sizeof params,
                       &error)) {
        return "";
    }
    (void)unlink(params_file().c_str());
    return error.text;
}

std::optional<ConfigReading> KeptConfig::load() const {
    if (access(config_file().c_str(), F_OK) != 0) {
        return std::nullopt;
    }
    return read_config(config_file(), Needs::peripherals);
}

std::optional<quiesce_params_t> KeptConfig::load_params() const {
    quiesce_params_t params{};
    linux_error_t error{};
    const bool is_read = nvm_file_read(params_file().c_str(), kParamKind, kVersion, &params,
                                       sizeof params, &error) == NVM_OK;
    return is_read && quiesce_params_check(&params, nullptr) ? std::optional(params) : std::nullopt;
}

} // namespace quiesced
