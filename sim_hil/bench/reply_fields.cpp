#include "reply_fields.h"

#include <iterator>

namespace quiesce {

namespace {

constexpr bool kUnsigned = false;
constexpr bool kSigned = true;

struct NamedWord {
    const char *name;
    bool is_signed;
};

constexpr NamedWord kTelemetry[] = {
    {"tick", kUnsigned},
    {"state", kUnsigned},
    {"fault", kUnsigned},
    {"fault_count", kUnsigned},
    {"bad_sample_count", kUnsigned},
    {"accel_um_s2", kSigned},
    {"velocity_um_s", kSigned},
    {"rms_um_s2", kSigned},
    {"freq_is_valid", kUnsigned},
    {"freq_age_ticks", kUnsigned},
    {"freq_uHz", kSigned},
    {"freq_amp_um_s2", kSigned},
    {"freq_phase_mdeg", kSigned},
    {"freq_sigma_uHz", kSigned},
    {"freq_window_ms", kUnsigned},
    {"displacement_nm", kSigned},
    {"displacement_amp_nm", kSigned},
    {"velocity_rms_um_s", kSigned},
    {"peak0_freq_uHz", kSigned},
    {"peak0_amp_um_s2", kSigned},
    {"peak0_phase_mdeg", kSigned},
    {"peak1_freq_uHz", kSigned},
    {"peak1_amp_um_s2", kSigned},
    {"peak1_phase_mdeg", kSigned},
    {"peak2_freq_uHz", kSigned},
    {"peak2_amp_um_s2", kSigned},
    {"peak2_phase_mdeg", kSigned},
    {"current_law_mA", kSigned},
    {"current_cmd_mA", kSigned},
    {"lock_is_on", kUnsigned},
};
static_assert(sizeof kTelemetry / sizeof kTelemetry[0] * 4 == sizeof(quiesce_telemetry_t));
static_assert(QUIESCE_PEAKS == 3);
static_assert(offsetof(lockstep_reply_t, telemetry) == 4 * (QUIESCE_MAX_DAMPERS + 1));

static_assert(offsetof(lockstep_reply_t, report) ==
              offsetof(lockstep_reply_t, telemetry) + sizeof(quiesce_telemetry_t));

constexpr const char *kOfBody[] = {"accel_um_s2", "velocity_um_s", "displacement_nm"};
constexpr const char *kOfDamper[] = {"stroke_nm",      "velocity_um_s", "force_mN",
                                     "current_mA",     "voltage_mV",    "temperature_mdegC",
                                     "current_law_mA", "current_cmd_mA"};
static_assert(sizeof(quiesce_picture_t) == 4 * (3 + std::size(kOfBody) * QUIESCE_MAX_BODIES +
                                                std::size(kOfDamper) * QUIESCE_MAX_DAMPERS));

template <std::size_t Count>
void append(const std::string &owner, std::size_t owners, const char *const (&names)[Count],
            std::vector<WordField> &out) {
    for (std::size_t i = 0; i < owners; ++i) {
        for (const char *name : names) {
            out.push_back({owner + std::to_string(i) + "_" + name, kSigned});
        }
    }
}

void append_numbered(const std::string &name, std::size_t count, std::vector<WordField> &out) {
    for (std::size_t i = 0; i < count; ++i) {
        out.push_back({name + std::to_string(i), kSigned});
    }
}

std::vector<WordField> all_fields() {
    std::vector<WordField> fields;
    append_numbered("reply_current_cmd_mA", QUIESCE_MAX_DAMPERS, fields);
    fields.push_back({"reply_drivers_enabled", kUnsigned});
    for (const NamedWord &word : kTelemetry) {
        fields.push_back({word.name, word.is_signed});
    }
    append_numbered("report", QUIESCE_REPORT_WORDS, fields);
    fields.push_back({"valid_low", kUnsigned});
    fields.push_back({"valid_high", kUnsigned});
    fields.push_back({"supply_mV", kSigned});
    append("body", QUIESCE_MAX_BODIES, kOfBody, fields);
    append("damper", QUIESCE_MAX_DAMPERS, kOfDamper, fields);
    return fields;
}

} // namespace

const std::vector<WordField> &reply_fields() {
    static const std::vector<WordField> fields = all_fields();
    return fields;
}

} // namespace quiesce
