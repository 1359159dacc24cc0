#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "loop.h"
#include "steady_ticks.h"

namespace quiesced {
namespace {

struct Command {
    std::int32_t current_mA;
    bool enable;
    bool operator==(const Command &other) const {
        return current_mA == other.current_mA && enable == other.enable;
    }
};

std::ostream &operator<<(std::ostream &out, const Command &command) {
    return out << command.current_mA << (command.enable ? " mA on" : " mA off");
}

/// A driver that keeps what it was told, in turn.
class FakeCurrent final : public CurrentDevice {
  public:
    explicit FakeCurrent(std::vector<Command> &told) {
        handle = {[](void *self, std::int32_t current_mA, bool enable) {
                      static_cast<std::vector<Command> *>(self)->push_back({current_mA, enable});
                  },
                  nullptr, &told};
    }
    std::uint32_t failures() const override { return 0; }
};

/// A sensor that keeps the axes that were asked for.
class FakeAccel final : public SensorDevice {
  public:
    explicit FakeAccel(std::vector<hal_axis_t> &axes) {
        handle = {[](void *self, hal_axis_t axis, std::int32_t *counts) {
                      auto &asked = *static_cast<std::vector<hal_axis_t> *>(self);
                      asked.push_back(axis);
                      *counts = static_cast<std::int32_t>(asked.size() % 7);
                      return true;
                  },
                  &axes};
    }
};

class LoopOf : public testing::Test {
  protected:
    LoopOf() {
        config.sensors.front().source = SensorSource::iio;
        config.outputs.front().output = CurrentOutput::pwm;
        quiesce_params_default(&params);
        params.law = QUIESCE_LAW_OFF;
        params.safe_current_mA = 250;
        params.accel_axis = QUIESCE_ACCEL_AXIS_X;
        exchange->peripherals.outputs[0].start_with(std::make_unique<FakeCurrent>(told));
        exchange->peripherals.sensors[0].start_with(std::make_unique<FakeAccel>(axes));
    }

    void start() {
        params.sensor_recover_ticks = 1;
        loop = std::make_unique<Loop>(config, params, *exchange, source, nullptr, nullptr);
    }

    Config config;
    quiesce_params_t params{};
    std::vector<Command> told;
    std::vector<hal_axis_t> axes;
    std::unique_ptr<Exchange> exchange = std::make_unique<Exchange>();
    SteadyTicks source;
    std::unique_ptr<Loop> loop;
};

const Command kSafeOn = {250, true};
const Command kSafeOff = {250, false};

TEST_F(LoopOf, the_driver_is_off_at_its_safe_current_until_the_first_tick) {
    start();
    EXPECT_EQ(told, std::vector<Command>{kSafeOff});
    EXPECT_TRUE(axes.empty());
}

TEST_F(LoopOf, refused_parameters_leave_the_driver_off) {
    params.slew_mA_s = -1;
    start();
    EXPECT_EQ(told, std::vector<Command>{kSafeOff});
}

TEST_F(LoopOf, a_fault_of_an_earlier_run_leaves_the_driver_off) {
    exchange->latched_fault.store(QUIESCE_FAULT_COIL_OPEN);
    start();
    loop->run(3);
    ASSERT_GE(told.size(), 4U);
    for (const Command &command : told) {
        EXPECT_EQ(command, kSafeOff);
    }
}

TEST_F(LoopOf, a_command_a_tick_then_the_safe_current_with_the_driver_off) {
    start();
    loop->run(3);
    // The first tick begins the self-test.
    const std::vector<Command> expected = {kSafeOff, kSafeOff, kSafeOn, kSafeOn,
                                           kSafeOff, kSafeOff, kSafeOff};
    EXPECT_EQ(told, expected);
}

/// The driver has the safe current of what comes while the controller still is as it was: here off,
/// because its parameters were refused.
TEST_F(LoopOf, a_restart_begins_with_the_safe_current) {
    quiesce_params_t other = params;
    other.safe_current_mA = 300;
    params.slew_mA_s = -1;
    start();
    ASSERT_TRUE(exchange->new_params.put(other));
    loop->run(1);
    const std::vector<Command> expected = {kSafeOff,     {300, false}, {300, false}, {300, false},
                                           {300, false}, {300, false}, {300, false}};
    EXPECT_EQ(told, expected);
}

TEST_F(LoopOf, refused_parameters_change_nothing) {
    quiesce_params_t other = params;
    other.safe_current_mA = -1;
    start();
    ASSERT_TRUE(exchange->new_params.put(other));
    loop->run(1);
    const std::vector<Command> expected = {kSafeOff, kSafeOff, kSafeOff, kSafeOff, kSafeOff};
    EXPECT_EQ(told, expected);
}

TEST_F(LoopOf, the_axis_that_the_parameter_names_is_read) {
    quiesce_params_t other = params;
    other.accel_axis = QUIESCE_ACCEL_AXIS_Y;
    start();
    loop->run(1);
    Snapshot last{};
    ASSERT_TRUE(exchange->snapshot.take(last)); // else the next run's end waits for room
    ASSERT_TRUE(exchange->new_params.put(other));
    loop->run(1);
    EXPECT_EQ(axes, (std::vector<hal_axis_t>{HAL_AXIS_X, HAL_AXIS_Y}));
}

TEST_F(LoopOf, of_refused_parameters_no_axis_is_taken) {
    params.accel_axis = 3;
    start();
    loop->run(1);
    EXPECT_EQ(axes, std::vector<hal_axis_t>{HAL_AXIS_Z});
}

} // namespace
} // namespace quiesced
