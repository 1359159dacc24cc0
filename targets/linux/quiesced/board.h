/// The board's side of a tick: sensors and inputs before the control step, drivers and lines after
/// it, and devices that are gone. Nothing in it waits.
#ifndef QUIESCED_BOARD_H
#define QUIESCED_BOARD_H

#include "bus_watch.h"
#include "change_log.h"
#include "emergency_stop.h"
#include "exchange.h"
#include "output_line.h"

namespace quiesced {

/// By number of the sensor.
using Axes = std::array<hal_axis_t, QUIESCE_SENSORS>;

class Board {
  public:
    /// exchange and its peripherals, bus and watchdog (null: none) must outlive it.
    Board(const Config &config, Exchange &exchange, can_bus_t *bus, watchdog_t *watchdog);
    Board(const Board &) = delete;
    Board &operator=(const Board &) = delete;

    /// What the board sees in the tick that begins. axes: of the accelerometers.
    node_inputs_t read(const Axes &axes, std::uint32_t elapsed, const hal_tick_t &timing);

    /// A damper's command, to a driver at this machine.
    void write_current(std::size_t damper, std::int32_t current_mA, bool enable);

    /// The tick's commands have left: with the demand frames at this time (0: they have not), or,
    /// where a driver is at this machine, when it was written. is_safe: safe currents, drivers off.
    void command_left(std::int64_t demand_ns, bool is_safe, std::uint32_t tick);

    /// rewrite: even where nothing has changed.
    void write_lines(bool is_driver_on, bool has_fault, bool rewrite);
    /// Ticks in a second; before the first tick and whenever it is another.
    void use_rate(std::uint32_t rate_Hz);

    void release_enable_line();
    void release_fault_line();

    /// Devices that are gone, and both watchdogs. rate_Hz: ticks in a second; once_a_second: this
    /// tick is the first of one.
    void look_after(std::uint32_t rate_Hz, bool once_a_second, ChangeLog &changes);
    void look_after_bus();

  private:
    bool read_enable();
    bool is_due(std::size_t sensor, std::uint32_t elapsed);
    quiesce_sample_t read_sensor(std::size_t sensor, hal_axis_t axis, std::uint32_t elapsed);
    quiesce_driver_t read_driver(std::size_t damper);
    bool is_on_bus(std::size_t damper) const;
    bool is_written(std::size_t damper);
    bool has_failed(std::size_t damper);
    bool are_drivable();
    void look_after_sensor(std::size_t sensor, std::uint32_t rate_Hz);
    void look_after_output(std::size_t damper, bool once_a_second, ChangeLog &changes);
    void feed_watchdogs(std::int64_t now_ns);

    const Config &config_;
    Exchange &exchange_;
    Peripherals &devices_;
    LogRing &log_;
    can_bus_t *bus_;
    BusWatch bus_watch_;
    watchdog_t *watchdog_;

    EmergencyStop estop_;
    OutputLine enable_output_{"enable_output"};
    OutputLine fault_output_{"fault_output"};
    struct SensorWatch {
        std::uint32_t silent_ticks = 0; ///< without a sample
        std::uint32_t wait_ticks = 0;   ///< until a channel with a period is read
        std::uint32_t period_ticks = 0; ///< between two readings of it; 0: it is read every tick
    };
    struct OutputWatch {
        std::uint32_t failures = 0;  ///< of the device, when the last second began
        std::int64_t written_ns = 0; ///< the last command; 0: it failed
    };
    std::array<SensorWatch, QUIESCE_SENSORS> sensors_{};
    std::array<OutputWatch, QUIESCE_DAMPERS> outputs_{};
    std::int64_t next_notice_ns_ = 0; ///< to the service manager
};

} // namespace quiesced

#endif
