#include "reply_fields.h"

#include <iterator>

namespace quiesce {

namespace {

constexpr bool kUnsigned = false;
constexpr bool kSigned = true;

constexpr WordField kTelemetry[] = {
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
static_assert(offsetof(lockstep_reply_t, telemetry) == 8);

constexpr WordField kReport[] = {
    {"report0", kSigned}, {"report1", kSigned}, {"report2", kSigned}, {"report3", kSigned},
    {"report4", kSigned}, {"report5", kSigned}, {"report6", kSigned}, {"report7", kSigned},
};
static_assert(std::size(kReport) == QUIESCE_REPORT_WORDS);
static_assert(offsetof(lockstep_reply_t, report) ==
              offsetof(lockstep_reply_t, telemetry) + sizeof(quiesce_telemetry_t));

std::vector<WordField> all_fields() {
    std::vector<WordField> fields = {{"reply_current_cmd_mA", kSigned},
                                     {"reply_is_driver_enabled", kUnsigned}};
    fields.insert(fields.end(), std::begin(kTelemetry), std::end(kTelemetry));
    fields.insert(fields.end(), std::begin(kReport), std::end(kReport));
    return fields;
}

} // namespace

const std::vector<WordField> &reply_fields() {
    static const std::vector<WordField> fields = all_fields();
    return fields;
}

} // namespace quiesce
