#include "config.h"

#include <filesystem>

namespace quiesced {

gpio_spec_t LineConfig::spec() const {
    gpio_spec_t spec{};
    spec.line = line.c_str();
    spec.is_active_low = is_active_low;
    spec.bias = static_cast<decltype(spec.bias)>(bias);
    return spec;
}

std::string Config::beside(const std::string &named) const {
    return (std::filesystem::path(file).parent_path() / named).string();
}

std::uint32_t Config::sensors_on_bus() const {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < sensors.size(); ++i) {
        bits |= sensors[i].source == SensorSource::can ? 1U << i : 0U;
    }
    return bits;
}

} // namespace quiesced
