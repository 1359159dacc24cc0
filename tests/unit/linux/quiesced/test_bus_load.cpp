/// The same figures as `quiesce can bus-load` (tests/python/benchmarks/test_can_bus_load.py).
#include <gtest/gtest.h>

#include "bus_load.h"

namespace quiesced {
namespace {

Config bus_of(std::size_t sensors, std::size_t dampers) {
    Config config;
    config.can.emplace().interface = "can0";
    config.sensors.assign(sensors, {});
    config.outputs.assign(dampers, {});
    quiesce_params_default(&config.params);
    return config;
}

double total_pct(const Config &config) {
    return bus_load(config, config.params).total();
}

TEST(BusLoad, longest_frames) {
    const std::uint32_t bytes[] = {0, 1, 2, 4, 5, 8};
    const std::uint32_t bits[] = {55, 65, 75, 95, 105, 135};
    for (int i = 0; i < 6; ++i) {
        EXPECT_EQ(classic_bits(bytes[i]), bits[i]);
    }
}

/// 17 + 13 bits and 4 stuff bits slow; 5 + 8 n + 27 and the other stuff bits fast.
TEST(BusLoad, longest_fd_frames) {
    EXPECT_EQ(fd_bits(0).nominal, 34U);
    EXPECT_EQ(fd_bits(0).data, 5U + 27U + (21U / 4U - 4U));
    EXPECT_EQ(fd_bits(8).nominal, 34U);
    EXPECT_EQ(fd_bits(8).data, 5U + 64U + 27U + (85U / 4U - 4U));
}

TEST(BusLoad, is_that_of_the_tools) {
    const struct {
        std::size_t sensors, dampers;
        double pct;
    } rows[] = {{0, 1, 33.7}, {1, 1, 54.7}, {1, 2, 75.6}, {2, 2, 96.6}, {0, 4, 96.4}};
    for (const auto &row : rows) {
        EXPECT_NEAR(total_pct(bus_of(row.sensors, row.dampers)), row.pct, 0.05)
            << row.sensors << " sensors, " << row.dampers << " dampers";
    }
}

TEST(BusLoad, follows_bit_rate_and_tick_rate) {
    Config config = bus_of(1, 1);
    config.can->bitrate = 250000;
    EXPECT_NEAR(total_pct(config), 109.43, 0.05);
    config.can->bitrate = 1000000;
    EXPECT_NEAR(total_pct(config), 27.35, 0.05);
    config.can->bitrate = 0;
    config.params.tick_rate_Hz = 500; // demands and samples come half as often
    EXPECT_NEAR(total_pct(config), 54.7 - 9.5 - 10.5, 0.05);
    config.params.tick_rate_Hz = 4000; // not more often than every millisecond
    EXPECT_NEAR(total_pct(config), 54.7, 0.05);
}

TEST(BusLoad, sensors_and_drivers_at_this_machine_cost_nothing) {
    Config config = bus_of(2, 2);
    config.sensors[0].source = SensorSource::iio;
    EXPECT_NEAR(bus_load(config, config.params).samples, 21.0, 0.01);
    config.sensors[1].source = SensorSource::adxl355;
    EXPECT_EQ(bus_load(config, config.params).samples, 0.0);
    const double before_pct = total_pct(config);
    config.outputs[1].output = CurrentOutput::pwm; // its demand goes out, its driver says nothing
    EXPECT_NEAR(total_pct(config), before_pct - 1.9, 0.01);
}

TEST(BusLoad, a_sensor_with_a_period_costs_its_period) {
    Config config = bus_of(2, 1);
    config.board.emplace();
    quiesce_board_default(&config.board->board.board);
    config.board->board.board.sensor[1].period_us = 10000;
    EXPECT_NEAR(bus_load(config, config.params).samples, 21.0 + 2.1, 0.01);
}

TEST(BusLoad, fd_frames_are_shorter_where_their_rate_is_known) {
    Config config = bus_of(2, 2);
    config.can->use_fd = true;
    EXPECT_NEAR(total_pct(config), 96.6, 0.05); // as classic
    config.can->data_bitrate = 2000000;
    const FdBits sample = fd_bits(5);
    const double sample_pct = 100.0 * 1000.0 * (sample.nominal / 5e5 + sample.data / 2e6);
    EXPECT_NEAR(bus_load(config, config.params).samples, 2.0 * sample_pct, 1e-9);
    EXPECT_LT(total_pct(config), 60.0);
}

} // namespace
} // namespace quiesced
