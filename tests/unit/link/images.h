/// The images that the link tests run, and what drives them.
#ifndef QUIESCE_TEST_IMAGES_H
#define QUIESCE_TEST_IMAGES_H

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <string>

#include "controller_link.h"
#include "input_error.h"
#include "qemu_options.h"

namespace quiesce {

const std::string kShmImage = QUIESCE_IMAGES "/quiesce_mps2_shm.elf";
const std::string kUartImage = QUIESCE_IMAGES "/quiesce_mps2_uart.elf";
const std::string kEchoImage = QUIESCE_IMAGES "/uart_echo.elf";

inline QemuOptions options_for(const std::string &image_path) {
    QemuOptions options;
    options.image_path = image_path;
    options.plugin_path = QUIESCE_PLUGIN;
    return options;
}

inline QemuOptions uncounted(const std::string &image_path) {
    QemuOptions options = options_for(image_path);
    options.plugin_path = "none";
    return options;
}

/// For targets that never answer.
inline QemuOptions impatient(const std::string &image_path) {
    QemuOptions options = uncounted(image_path);
    options.answer_time = std::chrono::milliseconds(300);
    return options;
}

inline quiesce_params_t default_params() {
    quiesce_params_t params;
    quiesce_params_default(&params);
    return params;
}

/// A stimulus whose every input moves: noise, dropouts, enable, a current now and then.
inline lockstep_stimulus_t varied_stimulus(std::uint32_t tick) {
    const std::uint32_t noise = (tick * 2654435761u) >> 12;
    lockstep_stimulus_t stimulus{static_cast<std::int32_t>(noise % 400001u) - 200000, 0, 0};
    stimulus.flags = LOCKSTEP_REPORT | (tick % 97 < 93 ? LOCKSTEP_FRESH : 0u);
    stimulus.flags |= tick % 1500 < 1400 ? LOCKSTEP_ENABLE : 0u;
    stimulus.flags |= tick == 1700 ? LOCKSTEP_ESTOP : 0u;
    stimulus.flags |= tick == 1800 ? LOCKSTEP_FAULT_RESET : 0u;
    if (tick % 3 == 0) {
        stimulus.flags |= LOCKSTEP_HAS_CURRENT;
        stimulus.current_meas_mA = static_cast<std::int32_t>(noise % 5000u) - 10;
    }
    return stimulus;
}

/// Message of the InputError that action must throw.
inline std::string error_of(const std::function<void()> &action) {
    try {
        action();
    } catch (const InputError &error) {
        return error.what();
    }
    ADD_FAILURE() << "no InputError";
    return "";
}

inline void expect_contains(const std::string &text, const std::string &part) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

} // namespace quiesce

#endif
