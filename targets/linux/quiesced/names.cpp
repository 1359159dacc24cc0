#include "names.h"

#include <array>

#include "quiesce_version.h"

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

const char *owner_name(quiesce_owner_t owner) {
    return owner == QUIESCE_OF_LAW ? "law" : "tracker";
}

const char *road_name(std::uint32_t road) {
    constexpr std::array<const char *, ROADS> names = {"the law's table", "the tracker's table",
                                                       "what was learnt"};
    return name_in(names, road);
}

const char *table_source_name(std::uint32_t source) {
    constexpr std::array<const char *, 5> names = {"none", "ships", "can", "stored",
                                                   "configuration"};
    return name_in(names, source);
}

const char *record_state_name(std::uint32_t state) {
    constexpr std::array<const char *, 3> names = {"whole", "older", "lost"};
    return name_in(names, state);
}

const char *verdict_text(quiesce_table_verdict_t verdict) {
    constexpr std::array<const char *, QUIESCE_TABLE_BOARD + 1> texts = {
        "accepted",
        "shorter than it says, or too long",
        "not a table that this law or tracker works with, or one of another version",
        "its checksum is wrong: it is damaged",
        "its numbers of inputs, outputs, rules, points or parts are out of range",
        "a membership is out of range",
        "a rule names what is not there",
        "a term is out of range",
        "made for another tick_rate_Hz, or for signals or dampers that are not there",
        "its points do not rise, or a coefficient, limit, band, power or current is out of range",
        "made for another board",
    };
    return name_in(texts, verdict);
}

const char *version() {
    return QUIESCED_VERSION(QUIESCE_VERSION_MAJOR, QUIESCE_VERSION_MINOR, QUIESCE_VERSION_PATCH);
}

} // namespace quiesced
