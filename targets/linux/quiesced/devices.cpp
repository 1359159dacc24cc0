#include "devices.h"

#include <filesystem>
#include <map>
#include <string>

#include "input_error.h"

namespace quiesced {

namespace {

constexpr std::uint32_t kRefresh_ms = 50;

[[noreturn]] void refuse(const std::string &key, const linux_error_t &error) {
    throw quiesce::InputError(key + ": " + error.text);
}

template <typename Pointer>
Pointer require(Pointer pointer, const std::string &key, const linux_error_t &error) {
    if (pointer == nullptr) {
        refuse(key, error);
    }
    return pointer;
}

class IioAccel final : public SensorDevice {
  public:
    IioAccel(const SensorConfig &config, const SystemFolders &folders) {
        const accel_iio_options_t options = {config.device.c_str(), config.use_buffer,
                                             config.trigger.empty() ? nullptr
                                                                    : config.trigger.c_str(),
                                             folders.iio.c_str(), folders.dev.c_str()};
        linux_error_t error{};
        self_ =
            require(accel_iio_open(&options, &handle, &error), config.place.key("device"), error);
    }
    IioAccel(const IioAccel &) = delete;
    IioAccel &operator=(const IioAccel &) = delete;
    ~IioAccel() override { accel_iio_close(self_); }

  private:
    accel_iio_t *self_;
};

class IioChannel final : public SensorDevice {
  public:
    IioChannel(const SensorConfig &config, const SystemFolders &folders) {
        const sensor_iio_options_t options = {config.device.c_str(), config.channel.c_str(),
                                              folders.iio.c_str()};
        linux_error_t error{};
        self_ =
            require(sensor_iio_open(&options, &handle, &error), config.place.key("channel"), error);
    }
    IioChannel(const IioChannel &) = delete;
    IioChannel &operator=(const IioChannel &) = delete;
    ~IioChannel() override { sensor_iio_close(self_); }

  private:
    sensor_iio_t *self_;
};

class Adxl355Accel final : public SensorDevice {
  public:
    explicit Adxl355Accel(const SensorConfig &config) {
        const accel_adxl355_options_t options = {config.device.c_str(), config.clock_Hz,
                                                 config.range_g, config.rate_Hz};
        linux_error_t error{};
        self_ = require(accel_adxl355_open(&options, &handle, &error), config.place.key("device"),
                        error);
    }
    Adxl355Accel(const Adxl355Accel &) = delete;
    Adxl355Accel &operator=(const Adxl355Accel &) = delete;
    ~Adxl355Accel() override { accel_adxl355_close(self_); }

  private:
    accel_adxl355_t *self_;
};

class PwmCurrent final : public CurrentDevice {
  public:
    PwmCurrent(const OutputConfig &config, const SystemFolders &folders) {
        const current_pwm_options_t options = {
            config.device.c_str(), config.channel,     config.period_ns,   config.full_scale_mA,
            kRefresh_ms,           config.is_inverted, folders.pwm.c_str()};
        linux_error_t error{};
        self_ =
            require(current_pwm_open(&options, &handle, &error), config.place.key("chip"), error);
    }
    PwmCurrent(const PwmCurrent &) = delete;
    PwmCurrent &operator=(const PwmCurrent &) = delete;
    ~PwmCurrent() override { current_pwm_close(self_); }
    std::uint32_t failures() const override { return current_pwm_failures(self_); }

  private:
    current_pwm_t *self_;
};

class DacCurrent final : public CurrentDevice {
  public:
    DacCurrent(const OutputConfig &config, const SystemFolders &folders) {
        const current_dac_options_t options = {
            config.device.c_str(), config.channel, config.zero_code,   config.full_scale_code,
            config.full_scale_mA,  kRefresh_ms,    folders.iio.c_str()};
        linux_error_t error{};
        self_ =
            require(current_dac_open(&options, &handle, &error), config.place.key("device"), error);
    }
    DacCurrent(const DacCurrent &) = delete;
    DacCurrent &operator=(const DacCurrent &) = delete;
    ~DacCurrent() override { current_dac_close(self_); }
    std::uint32_t failures() const override { return current_dac_failures(self_); }

  private:
    current_dac_t *self_;
};

class EnableLine final : public EnableInput {
  public:
    explicit EnableLine(Line line) : line_(std::move(line)) {}
    bool read(bool &is_active) override {
        // Nobody reads its edges; they must not pile up.
        constexpr int kMaxEdges = 64; // a tick; the rest waits for the next one
        gpio_edge_t edge;
        for (int i = 0; i < kMaxEdges && gpio_next_edge(line_.get(), &edge); ++i) {
        }
        return gpio_get(line_.get(), &is_active);
    }

  private:
    Line line_;
};

/// Where the kernel has the device; "" where it has none, which opening tells.
std::string resolved(const OutputConfig &output, const SystemFolders &folders) {
    sysfs_path_t folder{};
    std::error_code missing;
    if (output.output == CurrentOutput::dac) {
        const bool is_there =
            sysfs_find_iio(folders.iio.c_str(), output.device.c_str(), &folder, nullptr);
        return is_there ? std::filesystem::canonical(folder.text, missing).string() : "";
    }
    const auto chip = std::filesystem::path(folders.pwm) / output.device;
    return std::filesystem::canonical(chip, missing).string();
}

} // namespace

void refuse_shared_outputs(const Config &config) {
    std::map<std::string, const OutputConfig *> users;
    for (const OutputConfig &output : config.outputs) {
        const std::string place =
            output.output == CurrentOutput::can ? "" : resolved(output, config.folders);
        if (place.empty()) {
            continue;
        }
        const auto [user, is_new] =
            users.emplace(place + ":" + std::to_string(output.channel), &output);
        if (!is_new) {
            const bool is_pwm = output.output == CurrentOutput::pwm;
            throw quiesce::InputError(output.place.key(is_pwm ? "chip" : "device") + ": " +
                                      output.device + " is the device of " +
                                      user->second->place.title + ", " + user->second->device +
                                      " there; expected one of its own");
        }
    }
}

std::unique_ptr<SensorDevice> open_sensor(const SensorConfig &config,
                                          const SystemFolders &folders) {
    switch (config.source) {
    case SensorSource::iio:
        if (!config.channel.empty()) {
            return std::make_unique<IioChannel>(config, folders);
        }
        return std::make_unique<IioAccel>(config, folders);
    case SensorSource::adxl355:
        return std::make_unique<Adxl355Accel>(config);
    default:
        return nullptr;
    }
}

std::unique_ptr<CurrentDevice> open_current(const OutputConfig &config,
                                            const SystemFolders &folders) {
    switch (config.output) {
    case CurrentOutput::pwm:
        return std::make_unique<PwmCurrent>(config, folders);
    case CurrentOutput::dac:
        return std::make_unique<DacCurrent>(config, folders);
    default:
        return nullptr;
    }
}

Line open_output(const LineConfig &config, const char *key) {
    const gpio_spec_t spec = config.spec();
    linux_error_t error{};
    return Line(require(gpio_open_output(&spec, false, &error), key, error));
}

Line open_input(const LineConfig &config, const char *key) {
    const gpio_spec_t spec = config.spec();
    linux_error_t error{};
    return Line(require(gpio_open_input(&spec, &error), key, error));
}

std::unique_ptr<EnableInput> open_enable(const LineConfig &config, const char *key) {
    return std::make_unique<EnableLine>(open_input(config, key));
}

Watchdog open_watchdog(const WatchdogConfig &config) {
    linux_error_t error{};
    return Watchdog(require(watchdog_open(config.device.c_str(), config.timeout_s, &error),
                            "watchdog.device", error));
}

} // namespace quiesced
