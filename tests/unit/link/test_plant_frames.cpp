/// The plant on a controller's bus: what it sends, what it takes, and a real controller between.
#include "bus_link.h"

#include <algorithm>
#include <deque>

#include "images.h"

namespace quiesce {
namespace {

constexpr std::int32_t kRate_Hz = 1000;

lockstep_stimulus_t quiet_stimulus(std::uint32_t flags) {
    lockstep_stimulus_t stimulus{};
    stimulus.flags = flags | LOCKSTEP_FRESH;
    return stimulus;
}

std::size_t count_of(const std::vector<can_frame_t> &frames, std::size_t message) {
    const std::uint32_t id = quiesce_can_messages[message].e2e.id;
    return static_cast<std::size_t>(
        std::count_if(frames.begin(), frames.end(), [id](auto &frame) { return frame.id == id; }));
}

can_frame_t only(const std::vector<can_frame_t> &frames, std::size_t message) {
    EXPECT_EQ(count_of(frames, message), 1u);
    const std::uint32_t id = quiesce_can_messages[message].e2e.id;
    return *std::find_if(frames.begin(), frames.end(),
                         [id](auto &frame) { return frame.id == id; });
}

can_frame_t demand_frame(std::size_t damper, std::uint16_t current_mA, std::uint8_t &alive) {
    quiesce_can_current_demand_t demand{};
    demand.current_cmd_mA = current_mA;
    demand.driver_is_enabled = 1;
    const e2e_layout_t &layout = quiesce_can_messages[QUIESCE_CAN_AT_CURRENT_DEMAND + damper].e2e;
    can_frame_t frame = empty_frame(QUIESCE_CAN_AT_CURRENT_DEMAND + damper);
    quiesce_can_current_demand_pack(frame.data, &demand, sizeof frame.data);
    e2e_protect(&layout, &alive, &frame);
    return frame;
}

lockstep_reply_t answer_of(const PlantFrames &plant) {
    lockstep_reply_t reply{};
    plant.answer(reply);
    return reply;
}

TEST(plant_frames, messages_keep_their_cycle_at_every_rate) {
    for (const std::int32_t rate_Hz : {500, 1000, 4000}) {
        PlantFrames plant(rate_Hz);
        std::size_t samples = 0, currents = 0, commands = 0;
        for (std::int32_t tick = 0; tick < rate_Hz; ++tick) {
            const auto frames = plant.of_tick(quiet_stimulus(LOCKSTEP_HAS_CURRENT));
            samples += count_of(frames, QUIESCE_CAN_AT_ACCEL_SAMPLE);
            currents += count_of(frames, QUIESCE_CAN_AT_CURRENT_MEASURED);
            commands += count_of(frames, QUIESCE_CAN_AT_OPERATOR_COMMAND);
        }
        EXPECT_EQ(samples, static_cast<std::size_t>(std::min(rate_Hz, 1000))) << rate_Hz;
        EXPECT_EQ(currents, 100u) << rate_Hz;
        EXPECT_EQ(commands, 10u) << rate_Hz;
    }
}

TEST(plant_frames, a_sample_that_did_not_come_is_not_sent) {
    PlantFrames plant(kRate_Hz);
    lockstep_stimulus_t stimulus = quiet_stimulus(0);
    stimulus.flags &= ~LOCKSTEP_FRESH;
    EXPECT_EQ(count_of(plant.of_tick(stimulus), QUIESCE_CAN_AT_ACCEL_SAMPLE), 0u);
    stimulus.flags |= LOCKSTEP_LOST;
    EXPECT_TRUE(plant.of_tick(stimulus).empty());
}

TEST(plant_frames, a_count_beyond_its_bits_is_the_nearest_one_and_saturated) {
    for (const std::int32_t counts : {INT32_MIN, -0x800001, 0x800000, INT32_MAX}) {
        PlantFrames plant(kRate_Hz);
        lockstep_stimulus_t stimulus = quiet_stimulus(0);
        stimulus.counts[0] = counts;
        const can_frame_t frame = only(plant.of_tick(stimulus), QUIESCE_CAN_AT_ACCEL_SAMPLE);
        quiesce_can_accel_sample_t sample{};
        quiesce_can_accel_sample_unpack(&sample, frame.data, frame.length);
        EXPECT_EQ(sample.accel_counts, counts < 0 ? -0x800000 : 0x7FFFFF);
        EXPECT_EQ(sample.is_saturated, 1u);
    }
}

TEST(plant_frames, a_stop_does_not_wait_for_its_cycle) {
    PlantFrames plant(kRate_Hz);
    for (int tick = 0; tick < 7; ++tick) {
        EXPECT_EQ(count_of(plant.of_tick(quiet_stimulus(0)), QUIESCE_CAN_AT_EMERGENCY_STOP), 0u);
    }
    const auto frames = plant.of_tick(quiet_stimulus(LOCKSTEP_ESTOP));
    EXPECT_EQ(count_of(frames, QUIESCE_CAN_AT_EMERGENCY_STOP), 1u);
}

TEST(plant_frames, a_driver_without_demands_is_off_after_its_timeout) {
    const std::int32_t timeout =
        quiesce_can_messages[QUIESCE_CAN_AT_CURRENT_DEMAND].timeout_ms * kRate_Hz / 1000;
    PlantFrames plant(kRate_Hz);
    std::uint8_t alive = 0;
    EXPECT_EQ(answer_of(plant).drivers_enabled, 0u);
    plant.take(demand_frame(1, 1234, alive));
    for (std::int32_t tick = 0; tick < timeout; ++tick) {
        plant.of_tick(quiet_stimulus(0));
        EXPECT_EQ(answer_of(plant).drivers_enabled, 2u);
        EXPECT_EQ(answer_of(plant).current_cmd_mA[1], 1234);
    }
    plant.of_tick(quiet_stimulus(0));
    EXPECT_EQ(answer_of(plant).drivers_enabled, 0u);
    EXPECT_EQ(answer_of(plant).current_cmd_mA[1], 0);
}

TEST(plant_frames, a_damaged_demand_changes_nothing) {
    PlantFrames plant(kRate_Hz);
    std::uint8_t alive = 0;
    const can_frame_t good = demand_frame(0, 1000, alive);
    for (unsigned bit = 0; bit < 8u * good.length; ++bit) {
        can_frame_t frame = good;
        frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ 1u << bit % 8);
        plant.take(frame);
    }
    can_frame_t extended = good;
    extended.is_extended = true;
    plant.take(extended);
    can_frame_t shorter = good;
    shorter.length = 3;
    plant.take(shorter);
    EXPECT_EQ(answer_of(plant).current_cmd_mA[0], 0);
    plant.take(good);
    EXPECT_EQ(answer_of(plant).current_cmd_mA[0], 1000);
}

TEST(plant_frames, frames_of_nodes_that_are_played_here_are_known) {
    can_frame_t frame{};
    for (const std::size_t message :
         {QUIESCE_CAN_AT_ACCEL_SAMPLE, QUIESCE_CAN_AT_SENSOR_SAMPLE7,
          QUIESCE_CAN_AT_CURRENT_MEASURED, QUIESCE_CAN_AT_CURRENT_MEASURED3,
          QUIESCE_CAN_AT_OPERATOR_COMMAND}) {
        frame.id = quiesce_can_messages[message].e2e.id;
        EXPECT_TRUE(PlantFrames::is_ours(frame)) << message;
    }
    for (const std::size_t message : {QUIESCE_CAN_AT_EMERGENCY_STOP, QUIESCE_CAN_AT_STATUS,
                                      QUIESCE_CAN_AT_SERVICE_REQUEST, QUIESCE_CAN_AT_TABLE_DATA}) {
        frame.id = quiesce_can_messages[message].e2e.id;
        EXPECT_FALSE(PlantFrames::is_ours(frame)) << message;
    }
}

/// A line with a controller at its other end that has a tick after every burst, as fast as it is
/// asked; its frames wait for whoever reads.
class Line final : public FrameChannel {
  public:
    Line() {
        const quiesce_params_t params = default_params();
        EXPECT_TRUE(
            node_init(&node_, nullptr, &params, {NODE_ENABLE_CAN, (1u << QUIESCE_SENSORS) - 1u}));
    }

    std::string name() const override { return "line"; }

    void send(const can_frame_t *frames, std::size_t count, LinkClock::time_point) override {
        if (is_cut) {
            throw InputError("line: cut");
        }
        for (std::size_t i = 0; i < count; ++i) {
            node_receive(&node_, &frames[i]);
        }
    }

    bool receive(can_frame_t &frame, LinkClock::time_point) override {
        if (waiting_.empty()) {
            return false;
        }
        frame = waiting_.front();
        waiting_.pop_front();
        return true;
    }

    void tick() {
        node_inputs_t inputs{};
        inputs.ticks_elapsed = 1;
        std::array<can_frame_t, NODE_MAX_FRAMES> frames{};
        const std::uint32_t count = node_tick(&node_, &inputs, frames.data());
        waiting_.insert(waiting_.end(), frames.begin(), frames.begin() + count);
    }

    const quiesce_telemetry_t &telemetry() const { return node_.out.telemetry; }
    const can_node_counters_t &counters() const { return node_.can.receive.counters; }

    bool is_cut = false;

  private:
    node_t node_{};
    std::deque<can_frame_t> waiting_;
};

/// A bus with a controller, and a sensor that trembles.
struct Bus {
    void run(int ticks, std::uint32_t flags) {
        for (int i = 0; i < ticks; ++i) {
            noise = noise * 1664525u + 1013904223u;
            lockstep_stimulus_t stimulus = quiet_stimulus(flags | LOCKSTEP_HAS_CURRENT);
            stimulus.counts[0] = static_cast<std::int32_t>(noise >> 16) - 32768;
            stimulus.current_meas_mA[0] = reply.current_cmd_mA[0];
            link.look(reply);
            link.exchange(stimulus, reply);
            line->tick();
        }
    }

    Line *line = new Line;
    BusLink link{std::unique_ptr<FrameChannel>(line), nullptr};
    lockstep_reply_t reply{};
    std::uint32_t noise = 1;
};

TEST(bus_link, a_controller_on_the_bus_runs_stops_and_is_acknowledged) {
    Bus bus;
    bus.link.start(nullptr, default_params(), {});
    bus.run(1500, LOCKSTEP_ENABLE);
    EXPECT_EQ(bus.reply.telemetry.state, std::uint32_t{QUIESCE_STATE_RUN});
    EXPECT_EQ(bus.reply.drivers_enabled, 1u);
    EXPECT_EQ(bus.line->counters().rejected_crc + bus.line->counters().rejected_shape, 0u);
    bus.run(20, LOCKSTEP_ENABLE | LOCKSTEP_ESTOP);
    EXPECT_EQ(bus.line->telemetry().fault, std::uint32_t{QUIESCE_FAULT_ESTOP});
    EXPECT_EQ(bus.reply.drivers_enabled, 0u);
    bus.run(1000, 0);
    EXPECT_EQ(bus.reply.telemetry.fault, std::uint32_t{QUIESCE_FAULT_ESTOP});
    bus.run(1, LOCKSTEP_FAULT_RESET); // however short it is pressed
    bus.run(1000, 0);
    EXPECT_EQ(bus.reply.telemetry.fault, std::uint32_t{QUIESCE_FAULT_NONE});
    bus.run(1000, LOCKSTEP_ENABLE);
    EXPECT_EQ(bus.reply.telemetry.state, std::uint32_t{QUIESCE_STATE_RUN});
    bus.link.leave();
    bus.line->tick();
    EXPECT_NE(bus.line->telemetry().state, std::uint32_t{QUIESCE_STATE_RUN});
}

TEST(bus_link, the_plant_keeps_its_ticks_between_those_of_the_controller) {
    Bus bus;
    bus.link.start(nullptr, default_params(), {});
    bus.run(10, 0);
    lockstep_reply_t reply{};
    bus.link.half_way(); // its last demand came in the first half
    bus.link.look(reply);
    EXPECT_LT(bus.link.shift_ns(), 0);
    bus.link.half_way();
    bus.line->tick(); // in the second
    bus.link.look(reply);
    EXPECT_GT(bus.link.shift_ns(), 0);
    bus.link.half_way(); // none
    bus.link.look(reply);
    EXPECT_EQ(bus.link.shift_ns(), 0);
    bus.line->tick(); // in both
    bus.link.half_way();
    bus.line->tick();
    bus.link.look(reply);
    EXPECT_EQ(bus.link.shift_ns(), 0);
}

TEST(bus_link, a_line_that_ends_is_a_target_that_is_gone) {
    Bus bus;
    bus.link.start(nullptr, default_params(), {});
    bus.run(10, 0);
    bus.line->is_cut = true;
    EXPECT_THROW(bus.run(1, 0), TargetGone);
}

} // namespace
} // namespace quiesce
