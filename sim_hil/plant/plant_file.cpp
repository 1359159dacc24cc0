#include "plant_file.h"

#include <sstream>

#include "dampers_section.h"
#include "mounts_section.h"
#include "place_section.h"
#include "sensor_section.h"
#include "structure_section.h"
#include "toml_table.h"

namespace quiesce {

namespace {

CurrentDriverParams read_driver(TomlTable section) {
    CurrentDriverParams params{};
    params.max_current_A = section.number("max_current_A", {1e-3, 65.0, "A"});
    params.bits = static_cast<int>(section.integer("bits", 4, 24));
    section.reject_unknown_keys();
    return params;
}

ShakerParams read_shaker(TomlTable section, const Structure &structure) {
    ShakerParams params{};
    params.moves_base = section.has("gain_m_s2_V");
    params.gain_per_V = params.moves_base ? section.number("gain_m_s2_V", {-1e6, 1e6, "m/s2 per V"})
                                          : section.number("gain_N_V", {-1e6, 1e6, "N/V"});
    if (params.moves_base && structure.base_participation.isZero(0.0)) {
        section.fail("gain_m_s2_V", "the structure has no base_participation to feel it with");
    }
    params.drive_V = section.number("drive_V", {0.0, 1e6, "V"});
    params.ref_freq_Hz = section.number("ref_freq_Hz", {1e-3, 1e5, "Hz"}, 10.0);
    params.corner_Hz = section.number("corner_Hz", {0.0, 1e5, "Hz, 0: flat"}, 0.0);
    section.reject_unknown_keys();
    return params;
}

double read_max_step_s(TomlTable &root, const PlantModel &model) {
    constexpr double kDefault_us = 500.0;
    const double safe_us = 1e6 * longest_safe_step_s(model);
    std::optional<TomlTable> section = root.optional_table("integration");
    TomlTable &owner = section ? *section : root;
    const double step_us =
        section ? section->number("max_step_us", {1.0, 2000.0, "us"}) : kDefault_us;
    if (section) {
        section->reject_unknown_keys();
    }
    if (step_us > safe_us) {
        std::ostringstream message;
        message << step_us << " us is too long for this plant's fastest motion; set "
                << "integration.max_step_us to " << safe_us << " or less";
        owner.fail(section ? "max_step_us" : "integration", message.str());
    }
    return 1e-6 * step_us;
}

} // namespace

PlantModel load_plant(const std::string &file) {
    const TomlFile toml(file, "quiesce-plant", 1);
    TomlTable root = toml.root();
    root.text("schema");
    root.integer("version", 1, 1);
    PlantModel model{};
    model.name = root.text("name");
    StructureSection section = read_structure(root.table("structure"), has_damper_ends(root));
    model.structure = std::move(section.structure);
    model.places = read_places(root, model.structure, std::move(section.nodes));
    model.driver = read_driver(root.table("driver"));
    read_dampers(root, section.at_damper, model);
    read_mounts(root, model);
    model.shaker = read_shaker(root.table("shaker"), model.structure);
    read_sensors(root, model);
    model.max_step_s = read_max_step_s(root, model);
    root.reject_unknown_keys();
    return model;
}

} // namespace quiesce
