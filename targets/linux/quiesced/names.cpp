#include "names.h"

#include <array>

extern "C" {
#include "quiesce_version.h"
}

#define QUIESCED_TEXT(number) #number
#define QUIESCED_VERSION(major, minor, patch)                                                      \
    QUIESCED_TEXT(major) "." QUIESCED_TEXT(minor) "." QUIESCED_TEXT(patch)

namespace quiesced {

namespace {

static_assert(QUIESCE_STATE_COUNT == 8, "every state has a name");
constexpr std::array<const char *, QUIESCE_STATE_COUNT> kStates = {
    "INIT", "IDLE", "RUN", "SAFE", "FAULT", "ARMED", "DEGRADED", "SELF_TEST"};

template <std::size_t Count>
const char *name_in(const std::array<const char *, Count> &names, std::size_t index) {
    return index < Count ? names[index] : "?";
}

} // namespace

const char *state_name(std::uint32_t state) {
    return name_in(kStates, state);
}

const char *fault_name(std::uint32_t fault) {
#define QUIESCED_FAULT_CASE(name)                                                                  \
    case QUIESCE_FAULT_##name:                                                                     \
        return #name;
    switch (fault) {
        QUIESCE_EACH_FAULT(QUIESCED_FAULT_CASE)
    default:
        return "?";
    }
}

const char *bus_state_name(can_bus_state_t state) {
    constexpr std::array<const char *, 4> names = {"up", "down", "bus-off", "error passive"};
    return name_in(names, state);
}

const char *source_name(SensorSource source) {
    constexpr std::array names = {"can", "iio", "adxl355"};
    return names[static_cast<std::size_t>(source)];
}

const char *output_name(CurrentOutput output) {
    constexpr std::array names = {"can", "pwm", "dac"};
    return names[static_cast<std::size_t>(output)];
}

const char *version() {
    return QUIESCED_VERSION(QUIESCE_VERSION_MAJOR, QUIESCE_VERSION_MINOR, QUIESCE_VERSION_PATCH);
}

} // namespace quiesced
