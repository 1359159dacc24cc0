#include "devices.h"

#include "input_error.h"

namespace quiesced {

namespace {

constexpr const char *kIioRoot = "/sys/bus/iio/devices";

[[noreturn]] void refuse(const std::string &key, const linux_error_t &error) {
    throw quiesce::InputError(key + ": " + error.text);
}

template <typename Pointer>
Pointer require(Pointer pointer, const char *key, const linux_error_t &error) {
    if (pointer == nullptr) {
        refuse(key, error);
    }
    return pointer;
}

class IioAccel final : public AccelDevice {
  public:
    explicit IioAccel(const AccelConfig &config) {
        const accel_iio_options_t options = {
            config.device.c_str(), config.use_buffer,
            config.trigger.empty() ? nullptr : config.trigger.c_str(), kIioRoot, "/dev"};
        linux_error_t error{};
        self_ = require(accel_iio_open(&options, &handle, &error), "accel.device", error);
    }
    IioAccel(const IioAccel &) = delete;
    IioAccel &operator=(const IioAccel &) = delete;
    ~IioAccel() override { accel_iio_close(self_); }

  private:
    accel_iio_t *self_;
};

class Adxl355Accel final : public AccelDevice {
  public:
    explicit Adxl355Accel(const AccelConfig &config) {
        const accel_adxl355_options_t options = {config.device.c_str(), config.clock_Hz,
                                                 config.range_g, config.rate_Hz};
        linux_error_t error{};
        self_ = require(accel_adxl355_open(&options, &handle, &error), "accel.device", error);
    }
    Adxl355Accel(const Adxl355Accel &) = delete;
    Adxl355Accel &operator=(const Adxl355Accel &) = delete;
    ~Adxl355Accel() override { accel_adxl355_close(self_); }

  private:
    accel_adxl355_t *self_;
};

class PwmCurrent final : public CurrentDevice {
  public:
    explicit PwmCurrent(const CurrentConfig &config) {
        const current_pwm_options_t options = {config.device.c_str(), config.channel,
                                               config.period_ns,      config.full_scale_mA,
                                               config.is_inverted,    "/sys/class/pwm"};
        linux_error_t error{};
        self_ = require(current_pwm_open(&options, &handle, &error), "current.chip", error);
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
    explicit DacCurrent(const CurrentConfig &config) {
        const current_dac_options_t options = {config.device.c_str(), config.channel,
                                               config.zero_code,      config.full_scale_code,
                                               config.full_scale_mA,  kIioRoot};
        linux_error_t error{};
        self_ = require(current_dac_open(&options, &handle, &error), "current.device", error);
    }
    DacCurrent(const DacCurrent &) = delete;
    DacCurrent &operator=(const DacCurrent &) = delete;
    ~DacCurrent() override { current_dac_close(self_); }
    std::uint32_t failures() const override { return current_dac_failures(self_); }

  private:
    current_dac_t *self_;
};

} // namespace

std::unique_ptr<AccelDevice> open_accel(const AccelConfig &config) {
    switch (config.source) {
    case AccelSource::iio:
        return std::make_unique<IioAccel>(config);
    case AccelSource::adxl355:
        return std::make_unique<Adxl355Accel>(config);
    default:
        return nullptr;
    }
}

std::unique_ptr<CurrentDevice> open_current(const CurrentConfig &config) {
    switch (config.output) {
    case CurrentOutput::pwm:
        return std::make_unique<PwmCurrent>(config);
    case CurrentOutput::dac:
        return std::make_unique<DacCurrent>(config);
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

Watchdog open_watchdog(const WatchdogConfig &config) {
    linux_error_t error{};
    return Watchdog(require(watchdog_open(config.device.c_str(), config.timeout_s, &error),
                            "watchdog.device", error));
}

} // namespace quiesced
