#include <gtest/gtest.h>

#include "input_error.h"
#include "read_config.h"
#include "temporary_folder.h"

namespace quiesced {
namespace {

const std::string kCan = "[can]\ninterface = \"can0\"\n";
const std::string kAccel = "[accel]\nsource = \"can\"\n";
const std::string kCurrent = "[current]\noutput = \"can\"\n";
const std::string kBase = kCan + kAccel + kCurrent;

ConfigReading read(const std::string &text, Needs needs = Needs::peripherals) {
    const TemporaryFolder folder;
    write_text(folder / "q.toml", text);
    ConfigReading reading = read_config(folder / "q.toml", needs);
    for (std::string &line : reading.problems) {
        line.erase(0, folder.path().size() + 1); // "q.toml:LINE: ..."
    }
    return reading;
}

TEST(Config, the_least_that_is_needed_has_documented_defaults) {
    const ConfigReading reading = read(kBase);
    ASSERT_TRUE(reading.problems.empty()) << reading.problems.front();
    const Config &config = reading.config;
    EXPECT_EQ(config.loop.priority, 80);
    EXPECT_EQ(config.loop.cpu, -1);
    EXPECT_TRUE(config.loop.lock_memory);
    EXPECT_EQ(config.can->restart_ms, 100U);
    EXPECT_FALSE(config.gpio.estop_input);
    EXPECT_FALSE(config.watchdog);
    EXPECT_EQ(config.enable_from, NODE_ENABLE_CAN); // without gpio.enable_input
    EXPECT_EQ(config.state.folder, "/var/lib/quiesced");
    EXPECT_EQ(config.log.to, "journal");
    quiesce_params_t params;
    quiesce_params_default(&params);
    EXPECT_EQ(can_node_param_hash(&config.params), can_node_param_hash(&params));
}

TEST(Config, the_example_is_right) {
    const ConfigReading reading = read_config(QUIESCED_EXAMPLE, Needs::peripherals);
    EXPECT_TRUE(reading.problems.empty()) << reading.problems.front();
    EXPECT_EQ(reading.config.params.law, QUIESCE_LAW_PHASE);
}

TEST(Config, every_key_is_read) {
    const ConfigReading reading = read(
        "[loop]\npriority = 0\ncpu = 1\nlock_memory = false\n"
        "[can]\ninterface = \"slcan:/dev/ttyACM0\"\nfd = false\nrestart_ms = 50\n"
        "serial_baud = 1000000\nbitrate = 500000\n"
        "[accel]\nsource = \"adxl355\"\ndevice = \"/dev/spidev0.0\"\nclock_Hz = 1000000\n"
        "range_g = 8\nrate_Hz = 4000\n"
        "[current]\noutput = \"dac\"\ndevice = \"iio:device1\"\nchannel = 2\nzero_code = 10\n"
        "full_scale_code = 4095\nfull_scale_mA = 5000\n"
        "[gpio]\nestop_input = { line = \"ESTOP\", active_low = true, bias = \"pull-up\" }\n"
        "enable_output = { line = \"gpiochip0:3\" }\nfault_output = { line = \"F\" }\n"
        "enable_input = { line = \"E\", bias = \"off\" }\n"
        "data_ready_input = { line = \"D\", bias = \"pull-down\" }\n"
        "[operator]\nenable = \"both\"\n"
        "[watchdog]\ndevice = \"/dev/watchdog\"\ntimeout_s = 9\n"
        "[state]\nfolder = \"/run/q\"\nstatus_s = 2\n"
        "[log]\nto = \"/run/q.log\"\nlevel = \"debug\"\n"
        "[parameters]\nlaw = \"constant\"\nadapt = 2\naccel_polarity = -1\ntick_rate_Hz = 4000\n");
    ASSERT_TRUE(reading.problems.empty()) << reading.problems.front();
    const Config &config = reading.config;
    EXPECT_EQ(config.can->serial_baud, 1000000U);
    EXPECT_EQ(config.can->bitrate, 500000U);
    EXPECT_EQ(config.sensors.front().source, SensorSource::adxl355);
    EXPECT_EQ(config.sensors.front().range_g, 8U);
    EXPECT_EQ(config.sensors.front().rate_Hz, 4000U);
    EXPECT_EQ(config.outputs.front().output, CurrentOutput::dac);
    EXPECT_EQ(config.outputs.front().full_scale_code, 4095);
    const gpio_spec_t spec = config.gpio.estop_input->spec();
    EXPECT_STREQ(spec.line, "ESTOP");
    EXPECT_TRUE(spec.is_active_low);
    EXPECT_EQ(spec.bias, gpio_spec_t::GPIO_BIAS_PULL_UP);
    EXPECT_EQ(config.gpio.enable_input->spec().bias, gpio_spec_t::GPIO_BIAS_OFF);
    EXPECT_EQ(config.gpio.data_ready_input->spec().bias, gpio_spec_t::GPIO_BIAS_PULL_DOWN);
    EXPECT_EQ(config.gpio.enable_output->spec().bias, gpio_spec_t::GPIO_BIAS_AS_IS);
    EXPECT_EQ(config.enable_from, NODE_ENABLE_BOTH);
    EXPECT_EQ(config.watchdog->timeout_s, 9);
    EXPECT_EQ(config.state.status_s, 2U);
    EXPECT_EQ(config.log.level, LogLevel::debug);
    EXPECT_EQ(config.params.law, QUIESCE_LAW_CONSTANT);
    EXPECT_EQ(config.params.adapt, QUIESCE_ADAPT_FROZEN);
    EXPECT_EQ(config.params.accel_polarity, -1);
}

TEST(Config, iio_and_pwm_are_read) {
    const ConfigReading reading =
        read("[accel]\nsource = \"iio\"\ndevice = \"adxl355\"\nuse_buffer = false\n"
             "trigger = \"t0\"\n[current]\noutput = \"pwm\"\nchip = \"pwmchip0\"\nchannel = 1\n"
             "period_ns = 50000\nfull_scale_mA = 5000\nis_inverted = true\n"
             "[gpio]\nenable_input = { line = \"E\" }\n");
    ASSERT_TRUE(reading.problems.empty()) << reading.problems.front();
    EXPECT_FALSE(reading.config.can); // nothing needs a bus
    EXPECT_EQ(reading.config.sensors.front().trigger, "t0");
    EXPECT_FALSE(reading.config.sensors.front().use_buffer);
    EXPECT_EQ(reading.config.outputs.front().device, "pwmchip0");
    EXPECT_TRUE(reading.config.outputs.front().is_inverted);
}

SensorConfig read_accel(const std::string &accel, const std::string &more) {
    const ConfigReading reading =
        read("[accel]\nsource = \"adxl355\"\ndevice = \"d\"\n" + accel + kCan + kCurrent + more);
    EXPECT_TRUE(reading.problems.empty()) << reading.problems.front();
    return reading.config.sensors.front();
}

TEST(Config, tables_are_beside_the_file_and_not_looked_at) {
    const TemporaryFolder folder;
    write_text(folder / "q.toml", kBase + "[tables]\nlaw = \"a.table\"\ntracker = \"/b.table\"\n");
    const ConfigReading reading = read_config(folder / "q.toml", Needs::peripherals);
    ASSERT_TRUE(reading.problems.empty()) << reading.problems.front();
    EXPECT_EQ(reading.config.tables[QUIESCE_OF_LAW], folder / "a.table");
    EXPECT_EQ(reading.config.tables[QUIESCE_OF_TRACKER], "/b.table");
}

TEST(Config, the_sensor_is_by_default_as_fast_as_the_ticks_that_it_starts) {
    const std::string line = "[gpio]\ndata_ready_input = { line = \"D\" }\n";
    for (const char *rate : {"500", "1000", "2000", "4000"}) {
        const std::string parameters = std::string("[parameters]\ntick_rate_Hz = ") + rate + "\n";
        EXPECT_EQ(read_accel("", line + parameters).rate_Hz, std::stoul(rate));
    }
    EXPECT_EQ(read_accel("", line).rate_Hz, 1000U);
    EXPECT_EQ(read_accel("", "").rate_Hz, 2000U); // the timer starts the ticks
    EXPECT_EQ(read_accel("rate_Hz = 500\n", "").rate_Hz, 500U);
}

struct Malformed {
    const char *name;
    std::string text; ///< after kBase, which has 6 lines
    std::string line; ///< how the only problem begins
};

void PrintTo(const Malformed &row, std::ostream *out) {
    *out << row.name;
}

/// A key of so many parts that a parser without a bound overflows its stack.
std::string deep(const std::string &part) {
    std::string key = part;
    for (int i = 0; i < 50000; ++i) {
        key += "." + part;
    }
    return key;
}

class MalformedConfig : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedConfig, is_one_line_that_names_the_key) {
    const ConfigReading reading = read(kBase + GetParam().text);
    ASSERT_EQ(reading.problems.size(), 1U);
    EXPECT_EQ(reading.problems.front().rfind(GetParam().line, 0), 0U) << reading.problems.front();
    EXPECT_EQ(reading.problems.front().find('\n'), std::string::npos);
}

const Malformed kMalformed[] = {
    {"priority", "[loop]\npriority = 100\n", "q.toml:8: loop.priority: expected an integer in 0"},
    {"priority_type", "[loop]\npriority = \"high\"\n", "q.toml:8: loop.priority: expected"},
    {"priority_float", "[loop]\npriority = 1.5\n", "q.toml:8: loop.priority: expected"},
    {"cpu", "[loop]\ncpu = -2\n", "q.toml:8: loop.cpu: expected"},
    {"lock_memory", "[loop]\nlock_memory = 1\n", "q.toml:8: loop.lock_memory: expected true"},
    {"loop_key", "[loop]\nprio = 1\n", "q.toml:8: loop.prio: unknown key; expected one of: cpu, "},
    {"section", "[lopp]\n", "q.toml:7: lopp: unknown key"},
    {"not_a_table", "[gpio]\nestop_input = 3\n", "q.toml:8: gpio.estop_input: expected a table"},
    {"line_missing", "[gpio]\nestop_input = {}\n", "q.toml:8: gpio.estop_input.line: missing"},
    {"line_empty", "[gpio]\nestop_input = {line = \"\"}\n",
     "q.toml:8: gpio.estop_input.line: expected"},
    {"line_type", "[gpio]\nestop_input = {line = 3}\n", "q.toml:8: gpio.estop_input.line: expect"},
    {"line_control", "[gpio]\nfault_output = {line = \"a\\nb\"}\n",
     "q.toml:8: gpio.fault_output.line: expected a text without control"},
    {"bias", "[gpio]\nenable_input = {line = \"a\", bias = \"up\"}\n",
     "q.toml:8: gpio.enable_input.bias: expected one of: as-is, pull-up, pull-down, off"},
    {"active_low", "[gpio]\nenable_output = {line = \"a\", active_low = 0}\n",
     "q.toml:8: gpio.enable_output.active_low: expected true or false"},
    {"gpio_key", "[gpio]\nestop = {line = \"a\"}\n", "q.toml:8: gpio.estop: unknown key"},
    {"line_twice",
     "[gpio]\nestop_input = {line = \"a\"}\nfault_output = {line = \"b\"}\n"
     "enable_output = {line = \"a\"}\n",
     "q.toml:10: gpio.enable_output: \"a\" is the line of estop_input; expected another one"},
    {"enable", "[operator]\nenable = \"never\"\n", "q.toml:8: operator.enable: expected one of"},
    {"tables_key", "[tables]\nrules = \"a.table\"\n",
     "q.toml:8: tables.rules: unknown key; expected one of: law, tracker"},
    {"tables_type", "[tables]\nlaw = 3\n", "q.toml:8: tables.law: expected"},
    {"tables_empty", "[tables]\ntracker = \"\"\n", "q.toml:8: tables.tracker: expected"},
    {"tables_control", "[tables]\nlaw = \"a\\tb\"\n",
     "q.toml:8: tables.law: expected a text without control"},
    {"watchdog", "[watchdog]\n", "q.toml:7: watchdog.device: missing"},
    {"timeout", "[watchdog]\ndevice = \"/dev/watchdog\"\ntimeout_s = 0\n",
     "q.toml:9: watchdog.timeout_s: expected"},
    {"folder", "[state]\nfolder = \"here\"\n", "q.toml:8: state.folder: expected an absolute"},
    {"status", "[state]\nstatus_s = 0\n", "q.toml:8: state.status_s: expected"},
    {"log", "[log]\nto = \"syslog\"\n", "q.toml:8: log.to: expected \"journal\", "},
    {"level", "[log]\nlevel = \"all\"\n", "q.toml:8: log.level: expected one of"},
    {"param_name", "[parameters]\nlow = 1\n", "q.toml:8: parameters.low: no such parameter"},
    {"param_range", "[parameters]\nconstant_current_mA = 20001\n",
     "q.toml:8: parameters.constant_current_mA: expected an integer in 0 .. 20000"},
    {"param_type", "[parameters]\nconstant_current_mA = \"5 A\"\n",
     "q.toml:8: parameters.constant_current_mA: expected an integer"},
    {"param_label", "[parameters]\nlaw = \"magic\"\n",
     "q.toml:8: parameters.law: expected one of: off, constant, fuzzy, fuzzy_selftune, phase"},
    {"param_number", "[parameters]\nlaw = 50\n", "q.toml:8: parameters.law: expected an integer"},
    {"param_choice", "[parameters]\ntick_rate_Hz = 700\n",
     "q.toml:8: parameters.tick_rate_Hz: expected one of: 500, 1000, 2000, 4000; found 700"},
    {"param_contradiction", "[parameters]\nmax_current_mA = 6000\nsafe_current_mA = 7000\n",
     "q.toml:9: parameters.safe_current_mA: "},
    {"deep_key", deep("a") + " = 1\n", "q.toml:7: a key of more than 16 parts"},
    {"deep_table", "\n[" + deep("a") + "]\n", "q.toml:8: a key of more than 16 parts"},
    {"deep_tables", "[[" + deep("\"a#\"") + "]]\n", "q.toml:7: a key of more than 16 parts"},
    {"deep_inline", "a = [\"\"\"x\"\"\"\"\", {" + deep("a") + "=1}]\n",
     "q.toml:7: a key of more than 16 parts"},
    {"dots", "# " + std::string(99, '.') + "\nx = \"\\\"" + std::string(99, '.') + "\"\n",
     "q.toml:8: current.x: unknown key"},
    {"no_toml", "[parameters\n", "q.toml:7: "},
    {"twice", "[can]\n", "q.toml:7: "},
};

INSTANTIATE_TEST_SUITE_P(Config, MalformedConfig, testing::ValuesIn(kMalformed),
                         [](const auto &row) { return std::string(row.param.name); });

class MalformedTable : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedTable, is_told) {
    const ConfigReading reading = read(GetParam().text);
    ASSERT_FALSE(reading.problems.empty());
    EXPECT_EQ(reading.problems.front().rfind(GetParam().line, 0), 0U) << reading.problems.front();
}

const std::string kPwm = "[current]\noutput = \"pwm\"\n";
const std::string kDac = "[current]\noutput = \"dac\"\ndevice = \"d\"\nfull_scale_mA = 1\n";
const std::string kSpi = "[accel]\nsource = \"adxl355\"\ndevice = \"/dev/spidev0.0\"\n";
const Malformed kTables[] = {
    {"nothing", "", "q.toml"},
    {"no_can", kAccel + kCurrent, "q.toml:1: can: missing; accel.source needs"},
    {"no_accel", kCan + kCurrent, "q.toml:1: accel: missing"},
    {"no_current", kCan + kAccel, "q.toml:1: current: missing"},
    {"no_interface", "[can]\n" + kAccel + kCurrent, "q.toml:1: can.interface: missing"},
    {"long_interface", "[can]\ninterface = \"a123456789012345\"\n" + kAccel + kCurrent,
     "q.toml:2: can.interface: expected"},
    {"slash_interface", "[can]\ninterface = \"../can0\"\n" + kAccel + kCurrent,
     "q.toml:2: can.interface: expected"},
    {"relative_serial", "[can]\ninterface = \"slcan:ttyACM0\"\n" + kAccel + kCurrent,
     "q.toml:2: can.interface: expected"},
    {"serial_fd", "[can]\ninterface = \"slcan:/dev/x\"\nfd = true\n" + kAccel + kCurrent,
     "q.toml:3: can.fd: an SLCAN adapter has no CAN FD"},
    {"socket_baud", kCan + "serial_baud = 9600\n" + kAccel + kCurrent,
     "q.toml:3: can.serial_baud: only for an SLCAN adapter"},
    {"classic_data_bitrate", kCan + "data_bitrate = 500000\n" + kAccel + kCurrent,
     "q.toml:3: can.data_bitrate: only with fd = true"},
    {"full_bus", kCan + "bitrate = 250000\n" + kAccel + kCurrent,
     "q.toml:2: can.interface: the bus would be 109.4 % full at 250000 bit/s (demands 38.0, "},
    {"restart", kCan + "restart_ms = 0\n" + kAccel + kCurrent, "q.toml:3: can.restart_ms: expect"},
    {"source", kCan + "[accel]\nsource = \"usb\"\n" + kCurrent,
     "q.toml:4: accel.source: expected one of: can, iio, adxl355"},
    {"source_keys", kCan + kAccel + "device = \"x\"\n" + kCurrent,
     "q.toml:5: accel.device: unknown key; expected one of: source"},
    {"iio_device", kCan + "[accel]\nsource = \"iio\"\n" + kCurrent,
     "q.toml:3: accel.device: missing"},
    {"iio_buffer", kCan + "[accel]\nsource = \"iio\"\ndevice = \"a\"\nuse_buffer = 1\n" + kCurrent,
     "q.toml:6: accel.use_buffer: expected true"},
    {"iio_trigger", kCan + "[accel]\nsource = \"iio\"\ndevice = \"a\"\ntrigger = 1\n" + kCurrent,
     "q.toml:6: accel.trigger: expected"},
    {"spi_clock", kCan + kSpi + "clock_Hz = 20000000\n" + kCurrent,
     "q.toml:6: accel.clock_Hz: expected"},
    {"spi_range", kCan + kSpi + "range_g = 3\n" + kCurrent,
     "q.toml:6: accel.range_g: expected one of: 2, 4, 8; found 3"},
    {"spi_rate", kCan + kSpi + "rate_Hz = 1001\n" + kCurrent,
     "q.toml:6: accel.rate_Hz: expected one of"},
    {"output", kCan + kAccel + "[current]\noutput = \"i2c\"\n",
     "q.toml:6: current.output: expected one of: can, pwm, dac"},
    {"pwm_chip", kCan + kAccel + kPwm + "full_scale_mA = 1\nperiod_ns = 1000\n",
     "q.toml:5: current.chip: missing"},
    {"pwm_period", kCan + kAccel + kPwm + "chip = \"p\"\nfull_scale_mA = 1\nperiod_ns = 999\n",
     "q.toml:9: current.period_ns: expected"},
    {"pwm_scale", kCan + kAccel + kPwm + "chip = \"p\"\nfull_scale_mA = 0\nperiod_ns = 1000\n",
     "q.toml:8: current.full_scale_mA: expected"},
    {"pwm_channel", kCan + kAccel + kPwm + "chip = \"p\"\nchannel = 64\n",
     "q.toml:8: current.channel: expected"},
    {"pwm_inverted",
     kCan + kAccel + kPwm + "chip = \"p\"\nfull_scale_mA = 1\nperiod_ns = 1000\nis_inverted = 0\n",
     "q.toml:10: current.is_inverted: expected true"},
    {"spi_rate_of_the_ticks",
     kCan + kSpi + "rate_Hz = 2000\n" + kCurrent + "[gpio]\ndata_ready_input = {line = \"D\"}\n",
     "q.toml:6: accel.rate_Hz: accel.rate_Hz is 2000, tick_rate_Hz 1000; they must be the same"},
    {"pwm_beyond_scale",
     kCan + kAccel + kPwm + "chip = \"p\"\nperiod_ns = 1000\nfull_scale_mA = 4999\n",
     "q.toml:9: current.full_scale_mA: current.full_scale_mA is 4999, max_current_mA 5000; it "},
    {"dac_zero", kCan + kAccel + kDac, "q.toml:5: current.zero_code: missing"},
    {"dac_scale", kCan + kAccel + kDac + "zero_code = 5\nfull_scale_code = 5\n",
     "q.toml:10: current.full_scale_code: expected another code"},
    {"dac_type", kCan + kAccel + kDac + "zero_code = 0.5\nfull_scale_code = 5\n",
     "q.toml:9: current.zero_code: expected"},
};

INSTANTIATE_TEST_SUITE_P(Config, MalformedTable, testing::ValuesIn(kTables),
                         [](const auto &row) { return std::string(row.param.name); });

TEST(Config, all_that_is_wrong_is_told_at_once) {
    const ConfigReading reading = read("[loop]\npriority = -1\ncpu = 5000\n[accel]\n[x]\n");
    std::string all;
    for (const std::string &line : reading.problems) {
        all += line + "\n";
    }
    for (const char *key :
         {"loop.priority", "loop.cpu", "accel.source", "current: missing", "x: u"}) {
        EXPECT_NE(all.find(key), std::string::npos) << key << " in\n" << all;
    }
}

TEST(Config, the_program_stops_at_the_first_and_counts_the_others) {
    const TemporaryFolder folder;
    write_text(folder / "q.toml", kBase + "[loop]\npriority = -1\ncpu = 5000\n");
    try {
        (void)require_config(folder / "q.toml", Needs::peripherals);
        FAIL() << "accepted";
    } catch (const quiesce::InputError &error) {
        const std::string line = error.what();
        EXPECT_NE(line.find("loop.priority"), std::string::npos);
        EXPECT_NE(line.find("(and 1 more: --check)"), std::string::npos);
    }
}

TEST(Config, a_file_that_is_not_there_or_a_folder_is_told) {
    const TemporaryFolder folder;
    EXPECT_EQ(read_config(folder / "none", Needs::peripherals).problems.size(), 1U);
    EXPECT_FALSE(read_config(folder.path(), Needs::peripherals).problems.empty());
}

TEST(Config, the_lock_step_server_needs_a_bus_only) {
    EXPECT_TRUE(read(kCan, Needs::bus_only).problems.empty());
    EXPECT_FALSE(read(kAccel + kCurrent, Needs::bus_only).problems.empty());
}

} // namespace
} // namespace quiesced
