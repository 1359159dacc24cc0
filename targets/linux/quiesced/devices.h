/// The peripherals of a configuration, each an object that closes itself.
#ifndef QUIESCED_DEVICES_H
#define QUIESCED_DEVICES_H

#include <memory>

#include "config.h"
#include "firmware.h"

namespace quiesced {

/// A sensor that is read through a handle. The bus is none: its samples are in the node.
class SensorDevice {
  public:
    virtual ~SensorDevice() = default;
    hal_accel_t handle{};
};

/// A current driver at this machine. The bus is none: the demand frame goes out every tick.
class CurrentDevice {
  public:
    virtual ~CurrentDevice() = default;
    /// Writes that failed since the opening.
    virtual std::uint32_t failures() const = 0;
    hal_current_t handle{};
};

/// The operator's enable at this machine.
class EnableInput {
  public:
    virtual ~EnableInput() = default;
    /// Returns false, with is_active left alone, iff it is gone.
    virtual bool read(bool &is_active) = 0;
};

struct LineCloser {
    void operator()(gpio_line_t *line) const { gpio_close(line); }
};
struct WatchdogCloser {
    void operator()(watchdog_t *watchdog) const { watchdog_close(watchdog); }
};
using Line = std::unique_ptr<gpio_line_t, LineCloser>;
using Watchdog = std::unique_ptr<watchdog_t, WatchdogCloser>;

/// Throws InputError where two outputs lead to one channel of one device, under whatever names:
/// each would undo what the other is told.
void refuse_shared_outputs(const Config &config);

/// All throw InputError: "KEY: what, and what to do". Null where the source or output is the bus.
std::unique_ptr<SensorDevice> open_sensor(const SensorConfig &config, const SystemFolders &folders);
std::unique_ptr<CurrentDevice> open_current(const OutputConfig &config,
                                            const SystemFolders &folders);
/// key: of the line in the configuration, for the message. Outputs start inactive.
Line open_output(const LineConfig &config, const char *key);
Line open_input(const LineConfig &config, const char *key);
std::unique_ptr<EnableInput> open_enable(const LineConfig &config, const char *key);
Watchdog open_watchdog(const WatchdogConfig &config);

} // namespace quiesced

#endif
