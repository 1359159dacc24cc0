#include "segment_section.h"

#include <filesystem>
#include <sstream>

#include "base_tones_segment.h"
#include "chirp_segment.h"
#include "csv_columns.h"
#include "impulse_segment.h"
#include "input_error.h"
#include "random_segment.h"
#include "record_segment.h"
#include "sine_segment.h"
#include "tones_segment.h"

namespace quiesce {

namespace {

constexpr Range kFrequency = {1e-3, 1e4, "Hz"};
constexpr Range kDrive = {0.0, 1e6, "V"};
constexpr double kLongest_s = 1e5;
constexpr Range kDuration = {1e-3, kLongest_s, "s"};

struct Context {
    bool is_last;
};

/// How long a segment lasts that can go on for ever.
double read_open_duration_s(TomlTable &section, const Context &context) {
    return context.is_last ? section.number("duration_s", kDuration, kLongest_s)
                           : section.number("duration_s", kDuration);
}

template <typename... Parts>
std::string text(const Parts &...parts) {
    std::ostringstream out;
    (out << ... << parts);
    return out.str();
}

SegmentSpec read_sine(TomlTable &section, const Context &context) {
    SegmentSpec spec = lasting_sine(section.number("freq_Hz", kFrequency));
    spec.duration_s = read_open_duration_s(section, context);
    return spec;
}

SegmentSpec read_chirp(TomlTable &section, const Context & /*context*/) {
    const double start_Hz = section.number("freq_Hz", kFrequency);
    const double end_Hz = section.number("end_freq_Hz", kFrequency);
    const double duration_s = section.number("duration_s", kDuration);
    return {text("chirp, ", start_Hz, " Hz to ", end_Hz, " Hz"), duration_s, ShakenBy::shaker,
            [=](const ShakerParams &shaker) {
                return std::make_unique<ChirpSegment>(shaker, start_Hz, end_Hz, duration_s);
            }};
}

/// key: of their amplitudes.
std::vector<Tone> read_tone_tables(TomlTable &section, const std::string &key, const Range &range) {
    constexpr std::size_t kMostTones = 64;
    std::vector<Tone> tones;
    for (TomlTable &table : section.tables("tone")) {
        tones.push_back({table.number("freq_Hz", kFrequency), table.number(key, range),
                         table.number("phase_deg", {-360.0, 360.0, "degrees"}, 0.0)});
        table.reject_unknown_keys();
    }
    if (tones.empty() || tones.size() > kMostTones) {
        section.fail("tone",
                     "expected 1 .. " + std::to_string(kMostTones) + " tables [[segment.tone]]");
    }
    return tones;
}

/// "tones, 5 Hz at 0.1 V + 13 Hz at 0.2 V"
std::string summary_of(const char *kind, const std::vector<Tone> &tones, const char *unit) {
    std::string summary = kind;
    const char *before = ", ";
    for (const Tone &tone : tones) {
        summary += text(before, tone.freq_Hz, " Hz at ", tone.size, " ", unit);
        before = " + ";
    }
    return summary;
}

SegmentSpec read_tones(TomlTable &section, const Context &context) {
    const std::vector<Tone> tones = read_tone_tables(section, "drive_V", kDrive);
    return {summary_of("tones", tones, "V"), read_open_duration_s(section, context),
            ShakenBy::shaker, [tones](const ShakerParams &shaker) {
                return std::make_unique<TonesSegment>(shaker, tones);
            }};
}

SegmentSpec read_base_tones(TomlTable &section, const Context &context) {
    const std::vector<Tone> tones = read_tone_tables(section, "accel_m_s2", {0.0, 1e6, "m/s2"});
    std::vector<ToneLine> lines;
    for (const Tone &tone : tones) {
        lines.push_back({tone.freq_Hz, tone.size, tone.phase_deg / 360.0});
    }
    return {summary_of("base tones", tones, "m/s2"), read_open_duration_s(section, context),
            ShakenBy::base, [lines](const ShakerParams & /*shaker*/) {
                return std::make_unique<BaseTonesSegment>(lines);
            }};
}

SegmentSpec read_random(TomlTable &section, const Context & /*context*/) {
    RandomParams params{};
    params.low_Hz = section.number("low_Hz", kFrequency);
    params.high_Hz = section.number("high_Hz", kFrequency);
    params.drive_rms_V = section.number("drive_rms_V", kDrive);
    params.seed = static_cast<std::uint64_t>(section.integer("seed", 0, INT64_MAX, 1));
    params.least_repeat_s = section.number("duration_s", kDuration);
    if (params.high_Hz < 1.001 * params.low_Hz) {
        section.fail("high_Hz", "expected at least 1.001 times low_Hz");
    }
    const double longest_s = RandomSegment::kMostCycles / params.high_Hz;
    if (RandomSegment::repeat_s(params) > longest_s) {
        section.fail("duration_s", text("expected at most ", longest_s,
                                        " s, or a wider band; it would take too much memory"));
    }
    return {text("random, ", params.low_Hz, " .. ", params.high_Hz, " Hz at ", params.drive_rms_V,
                 " V RMS, seed ", params.seed),
            params.least_repeat_s, ShakenBy::shaker, [params](const ShakerParams &shaker) {
                return std::make_unique<RandomSegment>(shaker, params);
            }};
}

SegmentSpec read_impulse(TomlTable &section, const Context &context) {
    const double impulse_N_s = section.number("impulse_N_s", {-1e6, 1e6, "N s"});
    const double pulse_s = section.number("pulse_s", {1e-3, 10.0, "s"});
    const double duration_s = read_open_duration_s(section, context);
    if (pulse_s > duration_s) {
        section.fail("pulse_s", "expected no more than duration_s");
    }
    return {text("impulse, ", impulse_N_s, " N s in ", pulse_s, " s"), duration_s, ShakenBy::force,
            [=](const ShakerParams & /*shaker*/) {
                return std::make_unique<ImpulseSegment>(impulse_N_s, pulse_s);
            }};
}

std::vector<RecordPoint> load_record(const std::string &file, const std::string &time_column,
                                     const std::string &accel_column, double scale_m_s2) {
    std::vector<RecordPoint> points;
    for (const CsvRow &row : read_csv_columns(file, {time_column, accel_column})) {
        const double time_s = row.values[0];
        if (!points.empty() && time_s <= points.back().time_s) {
            throw InputError(text(file, ":", row.line, ": ", time_column,
                                  ": expected rising times, found ", time_s, " after ",
                                  points.back().time_s));
        }
        points.push_back({time_s, scale_m_s2 * row.values[1]});
    }
    if (points.size() < 2) {
        throw InputError(file + ":1: expected at least two rows of numbers");
    }
    return points;
}

SegmentSpec read_record(TomlTable &section, const Context &context) {
    const std::string file = section.path("file");
    const std::string time_column = section.text("time_column");
    const std::string accel_column = section.text("accel_column");
    const double scale_m_s2 = section.number("scale_m_s2", {1e-9, 1e9, "m/s2 per unit"}, 1.0);
    const double gain = section.number("gain", {-1e6, 1e6, "-"}, 1.0);
    const double time_scale = section.number("time_scale", {1e-3, 1e3, "-"}, 1.0);
    const double duration_s = read_open_duration_s(section, context);
    const auto points = load_record(file, time_column, accel_column, scale_m_s2);
    const double length_s = (points.back().time_s - points.front().time_s) / time_scale;
    return {text("base acceleration from ", file, ", ", length_s, " s"), duration_s, ShakenBy::base,
            [=](const ShakerParams & /*shaker*/) {
                return std::make_unique<RecordSegment>(points, gain, time_scale);
            }};
}

struct Kind {
    const char *name;
    SegmentSpec (*read)(TomlTable &section, const Context &context);
};

const Kind kKinds[] = {
    {"sine", read_sine},
    {"chirp", read_chirp},
    {"tones", read_tones},
    {"random", read_random},
    {"impulse", read_impulse},
    {"record", read_record},
    {"base_tones", read_base_tones},
};

} // namespace

SegmentSpec lasting_sine(double freq_Hz) {
    return {text("sine, ", freq_Hz, " Hz"), kLongest_s, ShakenBy::shaker,
            [freq_Hz](const ShakerParams &shaker) {
                return std::make_unique<SineSegment>(shaker, freq_Hz);
            }};
}

SegmentSpec read_segment(TomlTable &section, bool is_last) {
    std::vector<std::string> names;
    for (const Kind &kind : kKinds) {
        names.emplace_back(kind.name);
    }
    const std::string chosen = section.choice("kind", names);
    SegmentSpec spec{};
    for (const Kind &kind : kKinds) {
        if (chosen == kind.name) {
            spec = kind.read(section, {is_last});
        }
    }
    section.reject_unknown_keys();
    return spec;
}

} // namespace quiesce
