/// Several sensors and dampers from a board file.
#include <gtest/gtest.h>

#include <memory>

#include "board_fit.h"
#include "loop.h"
#include "read_config.h"
#include "status_file.h"
#include "steady_ticks.h"
#include "two_storeys.h"
#include "wiring_text.h"

namespace quiesced {
namespace {

class Wiring : public testing::Test {
  protected:
    /// The problems of a configuration that begins with a board.
    std::vector<std::string> problems(const std::string &rest) {
        write_text(rig.config_file(), "[board]\nfile = \"rig.board.toml\"\n" + rest + kEnable);
        std::vector<std::string> lines =
            read_config(rig.config_file(), Needs::peripherals).problems;
        for (std::string &line : lines) {
            line.erase(0, rig.folder.path().size() + 1); // "q.toml:LINE: ..."
        }
        return lines;
    }

    Config config() {
        Config out = require_config(rig.config_file(), Needs::peripherals);
        out.folders = rig.folders();
        return out;
    }

    TwoStoreys rig;
};

TEST_F(Wiring, every_part_is_in_its_place_on_the_board) {
    rig.write_config();
    const Config read = config();
    ASSERT_NE(read.wiring(), nullptr);
    ASSERT_EQ(read.sensors.size(), 3U);
    ASSERT_EQ(read.outputs.size(), 2U);
    EXPECT_EQ(read.sensors[0].place.name, "floor_accel");
    EXPECT_EQ(read.sensors[1].place.name, "roof_accel");
    EXPECT_EQ(read.sensors[2].place.name, "upper_stroke");
    EXPECT_EQ(read.sensors[2].channel, "voltage1");
    EXPECT_EQ(read.outputs[0].output, CurrentOutput::pwm);
    EXPECT_EQ(read.outputs[1].output, CurrentOutput::dac);
    EXPECT_EQ(read.outputs[1].place.key("device"), "damper.upper.device");
    EXPECT_EQ(read.sensors_on_bus(), 0U);
    EXPECT_FALSE(read.can); // nothing needs a bus
}

const std::string kCan = "[can]\ninterface = \"can0\"\n";

std::string on_bus(const char *section, const char *key, const std::vector<std::string> &names) {
    std::string out;
    for (const std::string &name : names) {
        out += std::string("[[") + section + "]]\nname = \"" + name + "\"\n" + key + " = \"can\"\n";
    }
    return out;
}

const std::string kBusSensors =
    on_bus("sensor", "source", {"floor_accel", "roof_accel", "upper_stroke"});
const std::string kBusDampers = on_bus("damper", "output", {"lower", "upper"});

struct Mistake {
    const char *name;
    std::string text; ///< after [board], which has 2 lines
    std::string line; ///< how the only problem begins
};

void PrintTo(const Mistake &row, std::ostream *out) {
    *out << row.name;
}

std::string replaced(std::string text, const std::string &old, const std::string &by) {
    return text.replace(text.find(old), old.size(), by);
}

class WrongWiring : public Wiring, public testing::WithParamInterface<Mistake> {};

TEST_P(WrongWiring, is_one_line_that_names_it) {
    const std::vector<std::string> lines = problems(GetParam().text);
    ASSERT_EQ(lines.size(), 1U) << (lines.empty() ? "accepted" : lines[0] + " | " + lines.back());
    EXPECT_EQ(lines[0].rfind(GetParam().line, 0), 0U) << lines[0];
    EXPECT_EQ(lines[0].find('\n'), std::string::npos);
}

const Mistake kMistakes[] = {
    {"accel", "[accel]\nsource = \"can\"\n" + kSensors + kDampers,
     "q.toml:3: accel: not with a board"},
    {"current", "[current]\noutput = \"can\"\n" + kSensors + kDampers,
     "q.toml:3: current: not with a board"},
    {"board_key", "axis = 3\n" + kSensors + kDampers, "q.toml:3: board.axis: unknown key"},
    {"sensor_missing", on_bus("sensor", "source", {"floor_accel", "roof_accel"}) + kCan + kDampers,
     "q.toml:3: sensor: the board's sensor \"upper_stroke\" has no table [[sensor]]"},
    {"damper_missing", kSensors + on_bus("damper", "output", {"upper"}) + kCan,
     "q.toml:18: damper: the board's damper \"lower\" has no table [[damper]]"},
    {"sensor_unknown",
     kSensors + kDampers + "[[sensor]]\nname = \"wind\"\nsource = \"can\"\n" + kCan,
     "q.toml:32: sensor[4].name: the board has no sensor \"wind\"; expected one of: floor_accel, "
     "roof_accel, upper_stroke"},
    {"damper_twice",
     kSensors + kDampers + "[[damper]]\nname = \"upper\"\noutput = \"can\"\n" + kCan,
     "q.toml:32: damper[3].name: \"upper\" has a table before this one"},
    {"name_type", kSensors + kDampers + "[[sensor]]\nname = 3\nsource = \"can\"\n" + kCan,
     "q.toml:32: sensor[4].name: expected a text"},
    {"sensor_key", replaced(kSensors, "device = \"adc\"", "device = \"adc\"\nbits = 3") + kDampers,
     "q.toml:7: sensor[1].bits: unknown key"},
    {"no_channel", replaced(kSensors, "channel = \"in_voltage1_raw\"\n", "") + kDampers,
     "q.toml:3: sensor[1].channel: missing; the board's upper_stroke measures no acceleration"},
    {"channel", replaced(kSensors, "in_voltage1_raw", "../voltage1") + kDampers,
     "q.toml:7: sensor[1].channel: expected a channel"},
    {"channel_with_buffer",
     replaced(kSensors, "device = \"adc\"", "device = \"adc\"\nuse_buffer = true") + kDampers,
     "q.toml:7: sensor[1].use_buffer: a channel is read by itself"},
    {"accelerometer_for_a_stroke",
     replaced(kSensors, "source = \"iio\"\ndevice = \"adc\"\nchannel = \"in_voltage1_raw\"",
              "source = \"adxl355\"\ndevice = \"/dev/spidev0.0\"") +
         kDampers,
     "q.toml:5: sensor[1].source: the board's upper_stroke measures no acceleration"},
    {"one_buffer_for_two",
     replaced(replaced(replaced(kSensors, "use_buffer = false\n", ""), "use_buffer = false\n", ""),
              "iio:device1", "iio:device0") +
         kDampers,
     "q.toml:3: sensor: roof_accel has the device of floor_accel"},
    {"one_output_for_two",
     kSensors + replaced(kDampers,
                         "output = \"dac\"\ndevice = \"dac\"\nzero_code = 7\n"
                         "full_scale_code = 2007",
                         "output = \"pwm\"\nchip = \"pwmchip0\"\nperiod_ns = 20000"),
     "q.toml:18: damper: upper has the device of lower"},
    {"ceiling", kSensors + replaced(kDampers, "full_scale_mA = 2000", "full_scale_mA = 1999"),
     "q.toml:24: damper[1].full_scale_mA: found 1999, the board's ceiling_mA is 2000"},
    {"parameter", kSensors + kDampers + "[parameters]\nsafe_current_mA = 5\n",
     "q.toml:32: parameters.safe_current_mA: comes from the board file"},
    {"axis", kSensors + kDampers + "[parameters]\naccel_axis = \"x\"\n",
     "q.toml:32: parameters.accel_axis: comes from the board file"},
    {"bus", kBusSensors + kDampers, "q.toml:1: can: missing; sensor.floor_accel.source needs"},
    {"full_bus", kBusSensors + kBusDampers + kCan,
     "q.toml:19: can.interface: the bus would be 117.6 % full at 500000 bit/s (demands 38.0, "
     "samples "
     "63.0, others 16.6), more than 80: a lower tick_rate_Hz, sensors at this machine or CAN FD"},
};

INSTANTIATE_TEST_SUITE_P(Wiring, WrongWiring, testing::ValuesIn(kMistakes),
                         [](const auto &row) { return std::string(row.param.name); });

TEST_F(Wiring, a_source_that_there_is_none_of_is_told_first) {
    const std::vector<std::string> lines =
        problems(replaced(kSensors, "\"iio\"", "\"usb\"") + kDampers);
    ASSERT_FALSE(lines.empty());
    EXPECT_EQ(lines[0].rfind("q.toml:5: sensor[1].source: expected one of: can, iio, adxl355", 0),
              0U)
        << lines[0];
}

TEST_F(Wiring, a_board_that_cannot_be_read_is_told_with_its_own_line) {
    write_text(rig.folder / "rig.board.toml", "schema = \"quiesce-board\"\nversion = 2\n");
    std::vector<std::string> lines = problems(kSensors + kDampers);
    ASSERT_EQ(lines.size(), 1U);
    EXPECT_EQ(lines[0].rfind("rig.board.toml:2: ", 0), 0U) << lines[0];
    std::filesystem::remove(rig.folder / "rig.board.toml");
    EXPECT_EQ(problems(kSensors + kDampers).size(), 1U);
}

/// --make-safe uses what can be read.
TEST_F(Wiring, outputs_are_known_without_their_board) {
    std::filesystem::remove(rig.folder / "rig.board.toml");
    rig.write_config();
    const ConfigReading reading = read_config(rig.config_file(), Needs::peripherals);
    ASSERT_EQ(reading.config.outputs.size(), 2U);
    EXPECT_EQ(reading.config.outputs[0].output, CurrentOutput::dac); // in the order of the file
    EXPECT_EQ(reading.config.outputs[1].device, "pwmchip0");
    write_text(rig.config_file(), "[board]\nfile = \"no\"\n" +
                                      on_bus("damper", "output", {"a", "b", "c", "d", "e", "f"}));
    // Two more than there can be: none of them may keep its current.
    const auto outputs = read_config(rig.config_file(), Needs::peripherals).config.outputs;
    std::string names;
    for (const OutputConfig &output : outputs) {
        names += output.place.name;
    }
    EXPECT_EQ(names, "abcdef");
}

TEST_F(Wiring, a_slower_tick_or_a_sensor_here_makes_room_on_the_bus) {
    EXPECT_TRUE(
        problems(kBusSensors + kBusDampers + kCan + "[parameters]\ntick_rate_Hz = 500\n").empty());
    EXPECT_TRUE(problems(kSensors + kBusDampers + kCan).empty());
    EXPECT_TRUE(
        problems(kBusSensors + kBusDampers + kCan + "fd = true\ndata_bitrate = 2000000\n").empty());
}

TEST_F(Wiring, a_law_that_lacks_a_signal_is_refused) {
    rig.write_config();
    Config read = config();
    EXPECT_FALSE(find_misfit(read, read.params));
    read.board->missing[QUIESCE_LAW_CONSTANT][0] = "force of upper";
    read.params.law = QUIESCE_LAW_CONSTANT;
    const std::optional<Misfit> misfit = find_misfit(read, read.params);
    ASSERT_TRUE(misfit);
    EXPECT_STREQ(quiesce_param_info(misfit->index)->name, "law");
    EXPECT_STREQ(misfit->reason.data(), "law constant needs signal force of upper, which no sensor "
                                        "of the board provides");
}

TEST_F(Wiring, check_lists_every_sensor_and_damper) {
    rig.write_config(kCan);
    const std::string text = wiring_text(config());
    for (const char *line : {"board two_storeys: ", "sensor floor_accel: iio iio:device0\n",
                             "sensor upper_stroke: iio adc channel voltage1\n",
                             "damper lower: pwm pwmchip0 channel 0, 2000 mA at full scale, ceiling "
                             "2000 mA, safe 40 mA\n",
                             "damper upper: dac dac channel 0",
                             "CAN load: 50.8 % at 500000 bit/s (demands 38.0, samples 0.0"}) {
        EXPECT_NE(text.find(line), std::string::npos) << line << " in\n" << text;
    }
}

/// A driver that keeps its last command; more failures than before: a write failed.
class FakeOutput final : public CurrentDevice {
  public:
    struct Told {
        std::int32_t current_mA = -1, most_mA = 0;
        bool enable = false;
        std::uint32_t failures = 0;
    };

    explicit FakeOutput(Told &told) : told_(told) {
        handle = {[](void *self, std::int32_t current_mA, bool enable) {
                      auto &last = *static_cast<Told *>(self);
                      last.current_mA = current_mA;
                      last.most_mA = std::max(last.most_mA, enable ? current_mA : 0);
                      last.enable = enable;
                  },
                  nullptr, &told};
    }
    std::uint32_t failures() const override { return told_.failures; }

  private:
    Told &told_;
};

/// Pressed after a while: its edge arms.
class FakeEnable final : public EnableInput {
  public:
    bool read(bool &is_active) override {
        is_active = ++reads_ > 10;
        return true;
    }

  private:
    int reads_ = 0;
};

class Running : public Wiring {
  protected:
    void SetUp() override {
        rig.write_config("[parameters]\nlaw = "
                         "\"constant\"\nconstant_current_mA = 5000\n"
                         "max_current_mA = 5000\nsensor_recover_ticks = 20\nslew_mA_s = 500000\n");
        settings = config();
        for (std::size_t i = 0; i < settings.sensors.size(); ++i) {
            exchange->peripherals.sensors[i].start_with(
                open_sensor(settings.sensors[i], settings.folders));
        }
    }

    /// Until its end; what it has left behind.
    Snapshot run(std::uint64_t ticks) {
        Snapshot last{};
        SteadyTicks source;
        exchange->latched_fault.store(QUIESCE_FAULT_NONE);
        exchange->peripherals.enable_input.start_with(std::make_unique<FakeEnable>());
        Loop(settings, settings.params, *exchange, source, nullptr, nullptr).run(ticks);
        EXPECT_TRUE(exchange->snapshot.take(last));
        return last;
    }

    void use_fakes() {
        for (std::size_t i = 0; i < told.size(); ++i) {
            exchange->peripherals.outputs[i].start_with(std::make_unique<FakeOutput>(told[i]));
        }
    }

    Config settings;
    std::unique_ptr<Exchange> exchange = std::make_unique<Exchange>();
    std::array<FakeOutput::Told, 2> told{};
};

TEST_F(Running, every_sensor_is_read_and_every_damper_driven_to_its_ceiling) {
    use_fakes();
    const Snapshot last = run(100);
    EXPECT_EQ(last.telemetry.state, QUIESCE_STATE_RUN);
    EXPECT_EQ(last.sensors[0].counts, 1100); // the board's axis x
    EXPECT_EQ(last.sensors[1].counts, 1201); // y
    EXPECT_EQ(last.sensors[2].counts, -1301);
    EXPECT_EQ(last.commands[0].current_cmd_mA, 2000);
    EXPECT_EQ(told[0].most_mA, 2000);
    EXPECT_EQ(told[1].most_mA, 2000);
    EXPECT_EQ(told[0].current_mA, 40); // it has left
    EXPECT_EQ(told[1].current_mA, 60);
    EXPECT_FALSE(told[0].enable || told[1].enable);
    const std::string json = status_json(settings, last);
    for (const char *part :
         {"{\"name\": \"roof_accel\", \"source\": \"iio\", \"counts\": 1201, \"is_fresh\": true}",
          "{\"name\": \"upper\", \"output\": \"dac\", \"current_cmd_mA\": 2000, "
          "\"is_driver_enabled\": true, \"current_meas_mA\": null, \"has_failed\": false}"}) {
        EXPECT_NE(json.find(part), std::string::npos) << part << " in\n" << json;
    }
}

TEST_F(Running, one_output_that_fails_is_the_fault_of_its_driver) {
    use_fakes();
    told[1].failures = 1; // of a write: the loop knows of none
    const Snapshot last = run(100);
    EXPECT_EQ(last.telemetry.fault, QUIESCE_FAULT_DRIVER_FAILED);
    EXPECT_TRUE(last.drivers[1].has_failed);
    EXPECT_FALSE(last.drivers[0].has_failed);
    EXPECT_EQ(told[0].most_mA, 0); // no tick has switched it on
    EXPECT_FALSE(told[0].enable || told[1].enable);
}

TEST_F(Running, a_sensor_that_is_gone_is_a_fault) {
    use_fakes();
    exchange->peripherals.sensors[2].give_up(); // no law asks for the stroke
    EXPECT_EQ(run(100).telemetry.state, QUIESCE_STATE_RUN);
    exchange->peripherals.sensors[1].give_up(); // the tracked one
    EXPECT_EQ(run(100).telemetry.fault, QUIESCE_FAULT_SENSOR_LOST);
}

TEST_F(Running, a_slow_channel_is_read_as_often_as_the_board_says) {
    use_fakes();
    settings.board->board.board.sensor[2].period_us = 50000;
    settings.board->board.board.sensor[2].max_age_us = 100000;
    EXPECT_FALSE(run(49).sensors[2].is_fresh);
    EXPECT_FALSE(run(50).sensors[2].is_fresh);
    EXPECT_TRUE(run(51).sensors[2].is_fresh); // ticks 1 and 51
}

TEST_F(Running, real_outputs_are_left_safe) {
    for (std::size_t i = 0; i < settings.outputs.size(); ++i) {
        exchange->peripherals.outputs[i].start_with(
            open_current(settings.outputs[i], settings.folders));
    }
    EXPECT_EQ(run(100).telemetry.state, QUIESCE_STATE_RUN);
    EXPECT_EQ(rig.first_line("pwm/pwmchip0/pwm0/enable"), "0");
    EXPECT_EQ(rig.first_line("iio/iio:device3/out_voltage0_raw"), "7");
}

TEST_F(Running, what_cannot_be_opened_is_named_by_its_key) {
    settings.sensors[2].channel = "voltage9";
    settings.outputs[0].device = "pwmchip9";
    try {
        (void)open_sensor(settings.sensors[2], settings.folders);
        FAIL() << "opened";
    } catch (const quiesce::InputError &error) {
        EXPECT_EQ(std::string(error.what()).rfind("sensor.upper_stroke.channel: ", 0), 0U);
        EXPECT_NE(std::string(error.what()).find("in_voltage9_raw"), std::string::npos);
    }
    try {
        (void)open_current(settings.outputs[0], settings.folders);
        FAIL() << "opened";
    } catch (const quiesce::InputError &error) {
        EXPECT_EQ(std::string(error.what()).rfind("damper.lower.chip: ", 0), 0U);
    }
}

} // namespace
} // namespace quiesced
