/// What the configuration of the controller program says (docs/reference/quiesced.md lists its
/// keys); read_config.h reads it.
#ifndef QUIESCED_CONFIG_H
#define QUIESCED_CONFIG_H

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "board_file.h"
#include "firmware.h"

namespace quiesced {

using TableWords = std::vector<std::uint32_t>;
inline constexpr std::array<quiesce_owner_t, QUIESCE_TABLE_OWNERS> kOwners = {QUIESCE_OF_LAW,
                                                                              QUIESCE_OF_TRACKER};

struct LoopConfig {
    int priority = 80; ///< SCHED_FIFO, 0: normal scheduling
    int cpu = -1;      ///< -1: any
    bool lock_memory = true;
};

struct CanConfig {
    std::string interface; ///< "can0", or "slcan:/dev/ttyACM0"
    bool use_fd = false;
    std::uint32_t restart_ms = 100;
    std::uint32_t serial_baud = 0;  ///< 0: leave it as it is
    std::uint32_t bitrate = 0;      ///< SLCAN: to set, 0: do not; else what `ip link` has set
    std::uint32_t data_bitrate = 0; ///< CAN FD, likewise; 0: not known

    bool is_serial() const { return interface.rfind("slcan:", 0) == 0; }
};

/// Where a sensor or damper stands in the file.
struct Place {
    std::string section;   ///< "accel" or "current", with a board "sensor" or "damper"
    std::size_t table = 0; ///< which [[sensor]] or [[damper]], from 0
    std::string name;      ///< on the board; "" without one
    std::string title;     ///< for people: "accelerometer", "sensor roof_accel"

    /// "accel.device", "sensor.roof_accel.device"
    std::string key(const char *of) const {
        return section + (name.empty() ? "" : "." + name) + "." + of;
    }
};

enum class SensorSource { can, iio, adxl355 };

struct SensorConfig {
    Place place{"accel", 0, "", "accelerometer"};
    SensorSource source = SensorSource::can;
    std::string device;
    std::string channel; ///< iio: "voltage0", read by itself; "": the axes of an accelerometer
    bool use_buffer = true;
    std::string trigger; ///< "": leave it as it is
    std::uint32_t clock_Hz = 5'000'000;
    std::uint32_t range_g = 2;
    std::uint32_t rate_Hz = 0; ///< adxl355; where it is not given, read_config chooses it
};

enum class CurrentOutput { can, pwm, dac };

struct OutputConfig {
    Place place{"current", 0, "", "current output"};
    CurrentOutput output = CurrentOutput::can;
    std::string device; ///< pwm: the chip
    std::uint32_t channel = 0;
    std::int32_t full_scale_mA = 0;
    std::uint32_t period_ns = 0;
    bool is_inverted = false;
    std::int32_t zero_code = 0;
    std::int32_t full_scale_code = 0;
};

struct LineConfig {
    std::string line;
    bool is_active_low = false;
    int bias = 0; ///< of gpio_spec_t

    gpio_spec_t spec() const;
};

struct GpioConfig {
    std::optional<LineConfig> enable_output;
    std::optional<LineConfig> fault_output;
    std::optional<LineConfig> estop_input;
    std::optional<LineConfig> enable_input;
    std::optional<LineConfig> data_ready_input;
};

struct WatchdogConfig {
    std::string device;
    int timeout_s = 5;
};

struct StateConfig {
    std::string folder = "/var/lib/quiesced";
    std::uint32_t status_s = 5; ///< pause between two writings of the status file
};

enum class LogLevel { error, warning, info, debug };

struct LogConfig {
    std::string to = "journal"; ///< "journal", "stderr" or a file's absolute path
    LogLevel level = LogLevel::info;
};

/// What is wired to what, from a board file.
struct WiredBoard {
    std::string file;
    quiesce::BoardFile board;
    /// By law, and for each by tracker: the signal that they need and no sensor provides ("stroke
    /// of upper"), "": none.
    std::vector<std::vector<std::string>> missing;
};

/// The kernel's folders; tests have others.
struct SystemFolders {
    std::string iio = "/sys/bus/iio/devices";
    std::string pwm = "/sys/class/pwm";
    std::string dev = "/dev";
};

struct Config {
    std::string file;
    LoopConfig loop;
    std::optional<CanConfig> can;
    std::optional<WiredBoard> board;       ///< without it parameters say what is wired
    std::vector<SensorConfig> sensors{{}}; ///< by number on the board
    std::vector<OutputConfig> outputs{{}}; ///< likewise, of dampers
    SystemFolders folders;
    GpioConfig gpio;
    node_enable_t enable_from = NODE_ENABLE_BOARD;
    std::optional<WatchdogConfig> watchdog;
    StateConfig state;
    LogConfig log;
    std::array<std::string, QUIESCE_TABLE_OWNERS> tables; ///< files by quiesce_owner_t, "": none
    quiesce_params_t params{};                            ///< defaults, and what [parameters] says

    /// Null without a board.
    const quiesce_board_t *wiring() const { return board ? &board->board.board : nullptr; }
    /// A file that it names, relative to its folder.
    std::string beside(const std::string &named) const;
    /// Bit i: sensor i.
    std::uint32_t sensors_on_bus() const;
};

} // namespace quiesced

#endif
