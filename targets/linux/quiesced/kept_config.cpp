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
constexpr std::uint32_t kVersion = QUIESCE_PARAM_LAYOUT; // of another release: not used
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
        const std::string board_file = config.board ? config.board->file : "";
        std::string board_text = config.board ? text_of(board_file) : "";
        // The board was read before its text: once more, so that both are of one state.
        const Config again = require_config(file, Needs::peripherals);
        const bool is_same_board =
            !config.board || (again.board && text_of(board_file) == board_text);
        if (text_of(file) == text && is_same_board) {
            return {again, std::move(text), std::move(board_text)};
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

std::string KeptConfig::keep(const std::string &text, const std::string &board_text,
                             const quiesce_params_t &params) {
    // Parameters and board of an earlier configuration do not belong to this one.
    (void)unlink(params_file().c_str());
    (void)unlink(board_file().c_str());
    std::string error = board_text.empty() ? "" : replace_file(board_file(), board_text);
    if (error.empty()) {
        error = replace_file(config_file(), text);
    }
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
    const bool has_board = access(board_file().c_str(), F_OK) == 0;
    return read_config(config_file(), Needs::peripherals, has_board ? board_file() : "");
}

std::optional<quiesce_params_t> KeptConfig::load_params() const {
    quiesce_params_t params{};
    linux_error_t error{};
    const bool is_read = nvm_file_read(params_file().c_str(), kParamKind, kVersion, &params,
                                       sizeof params, &error) == NVM_OK;
    return is_read && quiesce_params_check(&params, nullptr) ? std::optional(params) : std::nullopt;
}

} // namespace quiesced
