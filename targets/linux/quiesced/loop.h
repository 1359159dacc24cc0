/// The control loop: everything that happens in a tick. Nothing in it allocates, waits for a disk
/// or for another thread.
#ifndef QUIESCED_LOOP_H
#define QUIESCED_LOOP_H

#include <optional>

#include "bus.h"
#include "change_log.h"
#include "emergency_stop.h"
#include "fault_latch.h"
#include "output_line.h"
#include "tick_source.h"

namespace quiesced {

class Loop {
  public:
    /// Starts the controller from rest: the current driver gets the safe current. Where
    /// exchange.latched_fault has a fault, the driver stays off until it is acknowledged. exchange
    /// and its peripherals, bus and watchdog (null: none) must outlive the loop.
    Loop(const Config &config, const quiesce_params_t &params, Exchange &exchange, can_bus_t *bus,
         watchdog_t *watchdog);
    Loop(const Loop &) = delete;
    Loop &operator=(const Loop &) = delete;

    /// Puts back what law phase has learnt, and logs whether it is used.
    void use_adaptation(const quiesce_adaptation_t &adaptation);

    /// Runs until a stop is requested or, where ticks is not 0, for so many ticks; then safe
    /// current, output off, lines inactive, farewell on the bus.
    void run(std::uint64_t ticks);

  private:
    void tick(std::uint32_t elapsed);
    void receive();
    node_inputs_t board_inputs(std::uint32_t elapsed);
    bool board_enable();
    void take_new_params();
    void use_params(const quiesce_params_t &params);
    void answer_store();
    void keep_adaptation();
    void prepare_apply();
    void after_restart();
    void send(const can_frame_t *frames, std::uint32_t count);
    bool is_drivable();
    void write_lines();
    void look_after_devices();
    void look_after_bus();
    void look_after_accel();
    void look_after_current();
    void feed_watchdogs(std::int64_t now_ns);
    void report(std::int64_t now_ns);
    Snapshot snapshot() const;
    void put_snapshot();
    void put_adaptation();
    void put_params();
    void leave();
    bool say_farewell(const can_frame_t &frame);
    void put_last();

    bool is_safe_command() const;
    bool is_due_each_second() const { return exchange_.ticks.load() % rate_Hz_ == 0; }

    static bool read_accel(void *self, hal_axis_t axis, std::int32_t *counts);
    static void write_current(void *self, std::int32_t current_mA, bool enable);
    static bool read_current(void *self, std::int32_t *current_mA);
    static bool store(void *self, const quiesce_params_t *params);

    const Config &config_;
    Exchange &exchange_;
    Peripherals &devices_;
    LogRing &log_;
    can_bus_t *bus_;
    watchdog_t *watchdog_;

    hal_accel_t accel_{};
    hal_current_t current_{};
    node_t node_{};
    FaultLatch latch_;
    TickSource source_;
    EmergencyStop estop_;
    OutputLine enable_output_{"enable_output"};
    OutputLine fault_output_{"fault_output"};
    ChangeLog changes_;

    std::uint32_t rate_Hz_ = 0;
    std::uint32_t restarts_ = 0;
    std::uint32_t silent_ticks_ = 0; ///< without a sample of the accelerometer
    std::uint32_t current_failures_ = 0;
    std::uint32_t adaptation_age_s_ = 0;
    std::int64_t next_notice_ns_ = 0; ///< to the service manager
    bool store_is_pending_ = false;
    bool has_new_params_ = false; ///< that the other thread does not know yet
    bool is_written_ = false;     ///< the current of this tick, at this machine's driver
    quiesce_adaptation_t adaptation_{};
    bool has_adaptation_ = false;
};

} // namespace quiesced

#endif
