#include "sensor_section.h"

#include <filesystem>

#include "identifier.h"

namespace quiesce {

namespace {

constexpr Range kNoise = {0.0, 1e9, "RMS per sample"};
constexpr double kUm_s2PerMg = 1e3 * kGravity_m_s2;

using Names = std::vector<std::string>;

template <typename Items>
Names with_names(Names names, const Items &items) {
    for (const auto &item : items) {
        names.push_back(item.name);
    }
    return names;
}

/// `file` and `cross_talk_from`, one of the neighbours.
WiredSensor read_wired(TomlTable &section, const Names &neighbours) {
    WiredSensor sensor;
    sensor.params = load_sensor(section.path("file"));
    if (section.has("cross_talk_from")) {
        sensor.cross_talk_from = section.choice("cross_talk_from", neighbours);
        if (sensor.params.cross_talk == 0.0) {
            section.fail("cross_talk_from", "its file has no cross_talk_pct; leave it out");
        }
    }
    return sensor;
}

void require_acceleration(const TomlTable &section, const std::string &unit) {
    if (unit != "um/s2") {
        section.fail("file", "expected a sensor in um/s2, an accelerometer; found one in " + unit);
    }
}

/// [sensor]: the plant's own accelerometer with its converter.
void read_own(TomlTable section, PlantModel &model) {
    AccelerometerParams &params = model.sensor;
    if (section.has("file")) {
        model.transducer = read_wired(section, with_names({}, model.places));
        require_acceleration(section, model.transducer->params.unit);
    }
    params.full_scale_g = section.number("full_scale_g", {1e-3, 1e4, "g"});
    params.bits = static_cast<int>(section.integer("bits", 8, 24));
    params.noise_mg =
        section.number("noise_mg", {0.0, 1e4, "mg RMS per sample"},
                       model.transducer ? model.transducer->params.noise / kUm_s2PerMg : 0.0);
    const std::int64_t half = std::int64_t{1} << (params.bits - 1);
    params.offset_counts =
        static_cast<std::int32_t>(section.integer("offset_counts", 1 - half, half - 1, 0));
    section.reject_unknown_keys();
}

/// [sensors]: of a board, whose names the bench knows.
void read_of_board(TomlTable section, PlantModel &model) {
    const Names neighbours = with_names(with_names({}, model.places), model.dampers);
    for (const std::string &name : section.keys()) {
        require_identifier(section, name, name);
        TomlTable one = section.table(name);
        model.sensors[name] = read_wired(one, neighbours);
        one.reject_unknown_keys();
    }
}

void read_noise(TomlTable section, PlantModel &model) {
    for (const std::string &name : section.keys()) {
        require_identifier(section, name, name);
        model.noise[name] = section.number(name, kNoise);
    }
}

} // namespace

SensorParams load_sensor(const std::string &file) {
    const TomlFile toml(file, "quiesce-sensor", 1);
    TomlTable root = toml.root();
    root.text("schema");
    root.integer("version", 1, 1);
    SensorParams params{};
    params.name = root.text("name");
    params.unit = root.choice("unit", {"um/s2", "um/s", "nm", "mN"});
    params.corner_Hz = root.number("corner_Hz", {0.0, 1e5, "Hz, 0: none"}, 0.0);
    params.band_Hz = root.number("band_Hz", {0.0, 1e9, "Hz, 0: no limit"}, 0.0);
    params.noise = root.number("noise", kNoise, 0.0);
    params.drift = root.number("drift", {0.0, 1e9, "RMS"}, 0.0);
    params.drift_s = root.number("drift_s", {1e-3, 1e6, "s"}, 100.0);
    params.cross_talk = 1e-2 * root.number("cross_talk_pct", {-100.0, 100.0, "%"}, 0.0);
    params.cross_talk_per_A = root.number("cross_talk_per_A", {-1e9, 1e9, "per A"}, 0.0);
    if (params.band_Hz > 0.0 && params.band_Hz <= params.corner_Hz) {
        root.fail("band_Hz", "expected more than corner_Hz");
    }
    root.accept("source"); // for people
    root.reject_unknown_keys();
    return params;
}

void read_sensors(TomlTable &root, PlantModel &model) {
    read_own(root.table("sensor"), model);
    if (std::optional<TomlTable> section = root.optional_table("sensors")) {
        read_of_board(*section, model);
    }
    if (std::optional<TomlTable> section = root.optional_table("noise")) {
        read_noise(*section, model);
    }
}

} // namespace quiesce
