/// The images that the link tests run, and what drives them.
#ifndef QUIESCE_TEST_IMAGES_H
#define QUIESCE_TEST_IMAGES_H

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstddef>
#include <functional>
#include <string>

#include "controller_link.h"
#include "input_error.h"
#include "qemu_options.h"

namespace quiesce {

const std::string kShmImage = QUIESCE_IMAGES "/quiesce_mps2_shm.elf";
const std::string kLargestImage = QUIESCE_IMAGES "/quiesce_mps2_shm_8x4.elf";
const std::string kLargestUartImage = QUIESCE_IMAGES "/quiesce_mps2_uart_8x4.elf";
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

/// Words of a reply that CAN frames bring: with every command, and at the most. The rest of it, a
/// picture, stays here.
constexpr std::size_t kCommandWords = QUIESCE_MAX_DAMPERS + 4;
constexpr std::size_t kWordsOverCan = offsetof(lockstep_reply_t, picture) / 4;

inline quiesce_params_t default_params() {
    quiesce_params_t params;
    quiesce_params_default(&params);
    return params;
}

/// All that there can be: four bodies with accelerometers, three strokes and a force, four dampers.
inline quiesce_board_t largest_board() {
    quiesce_board_t board;
    quiesce_board_default(&board);
    board.sensors = QUIESCE_MAX_SENSORS;
    board.bodies = QUIESCE_MAX_BODIES;
    board.dampers = QUIESCE_MAX_DAMPERS;
    for (std::int32_t i = 0; i < 4; ++i) {
        board.sensor[i] = board.sensor[4 + i] = board.sensor[0];
        board.sensor[i].at = i;
        board.sensor[4 + i].sense = i < 3 ? QUIESCE_SENSE_STROKE : QUIESCE_SENSE_FORCE;
        board.sensor[4 + i].at = i;
        board.sensor[4 + i].scale = 10;
        board.damper[i] = board.damper[0];
        board.damper[i].end_a = i;
        board.damper[i].end_b = i == 0 ? QUIESCE_GROUND : i - 1;
        board.damper[i].ceiling_mA = board.damper[i].continuous_mA = 2000 + 500 * i;
        board.damper[i].measures_current = i % 2;
    }
    return board;
}

/// A stimulus whose every input moves: noise, dropouts, enable, a current now and then.
inline lockstep_stimulus_t varied_stimulus(std::uint32_t tick) {
    const std::uint32_t noise = (tick * 2654435761u) >> 12;
    lockstep_stimulus_t stimulus{0, {static_cast<std::int32_t>(noise % 400001u) - 200000}, {0}};
    stimulus.flags = LOCKSTEP_REPORT | (tick % 97 < 93 ? LOCKSTEP_FRESH : 0u);
    stimulus.flags |= tick > 0 && tick % 1500 < 1400 ? LOCKSTEP_ENABLE : 0u;
    stimulus.flags |= tick == 1700 ? LOCKSTEP_ESTOP : 0u;
    stimulus.flags |= tick == 1800 ? LOCKSTEP_FAULT_RESET : 0u;
    if (tick % 3 == 0) {
        stimulus.flags |= LOCKSTEP_HAS_CURRENT;
        stimulus.current_meas_mA[0] = static_cast<std::int32_t>(noise % 5000u) - 10;
    }
    for (std::uint32_t i = 1; i < QUIESCE_MAX_SENSORS; ++i) {
        stimulus.counts[i] = static_cast<std::int32_t>((noise * (2 * i + 1)) % 300001u) - 150000;
        stimulus.flags |= (tick + i) % 89 < 86 ? LOCKSTEP_FRESH << i : 0u;
    }
    for (std::uint32_t i = 1; i < QUIESCE_MAX_DAMPERS; ++i) {
        stimulus.flags |= (tick + i) % 2 == 0 ? LOCKSTEP_HAS_CURRENT << i : 0u;
        stimulus.current_meas_mA[i] = static_cast<std::int32_t>(noise % 300u);
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
