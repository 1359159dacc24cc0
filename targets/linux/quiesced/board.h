/// The board's side of a tick: sensors and inputs before the control step, driver and lines after
/// it, and devices that are gone. Nothing in it waits.
#ifndef QUIESCED_BOARD_H
#define QUIESCED_BOARD_H

#include "change_log.h"
#include "emergency_stop.h"
#include "exchange.h"
#include "output_line.h"

namespace quiesced {

class Board {
  public:
    /// exchange and its peripherals, bus and watchdog (null: none) must outlive it.
    Board(const Config &config, Exchange &exchange, can_bus_t *bus, watchdog_t *watchdog);
    Board(const Board &) = delete;
    Board &operator=(const Board &) = delete;

    /// What the board sees in the tick that begins. axis: of the accelerometer.
    node_inputs_t read(hal_axis_t axis, std::uint32_t elapsed, const hal_tick_t &timing);

    /// The command, to a driver at this machine.
    void write_current(std::int32_t current_mA, bool enable);

    /// The tick's command has left: with the demand frame at this time (0: it has not), or, where
    /// the driver is at this machine, when it was written. is_safe: safe current, driver off.
    void command_left(std::int64_t demand_ns, bool is_safe, std::uint32_t tick);

    /// rewrite: even where nothing has changed, to notice that a line is gone.
    void write_lines(bool is_driver_on, bool has_fault, bool rewrite);
    void release_enable_line();
    void release_fault_line();

    /// Devices that are gone, and both watchdogs. rate_Hz: ticks in a second; once_a_second: this
    /// tick is the first of one.
    void look_after(std::uint32_t rate_Hz, bool once_a_second, ChangeLog &changes);
    void look_after_bus();

  private:
    bool read_enable();
    void read_accel(hal_axis_t axis, node_inputs_t &inputs);
    void read_current(node_inputs_t &inputs);
    bool is_drivable();
    void look_after_accel(std::uint32_t rate_Hz);
    void look_after_current(bool once_a_second, ChangeLog &changes);
    void feed_watchdogs(std::int64_t now_ns);

    const Config &config_;
    Exchange &exchange_;
    Peripherals &devices_;
    LogRing &log_;
    can_bus_t *bus_;
    watchdog_t *watchdog_;

    EmergencyStop estop_;
    OutputLine enable_output_{"enable_output"};
    OutputLine fault_output_{"fault_output"};
    std::uint32_t silent_ticks_ = 0; ///< without a sample of the accelerometer
    std::uint32_t current_failures_ = 0;
    std::int64_t next_notice_ns_ = 0; ///< to the service manager
    std::int64_t written_ns_ = 0;     ///< the last command, at this machine's driver; 0: it failed
};

} // namespace quiesced

#endif
