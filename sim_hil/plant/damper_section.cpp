#include "damper_section.h"

#include "squeeze_biviscosity.h"
#include "switched_stiffness.h"
#include "viscous.h"

namespace quiesce {

namespace {

std::shared_ptr<const Damper> read_squeeze_biviscosity(TomlTable &section) {
    SqueezeBiviscosityParams params{};
    params.plate_radius_m = section.number("plate_radius_m", {1e-4, 1.0, "m"});
    params.gap_m = section.number("gap_m", {1e-6, 0.1, "m"});
    params.min_gap_m = section.number("min_gap_m", {1e-9, 0.1, "m"}, 0.01 * params.gap_m);
    params.viscosity_Pa_s = section.number("viscosity_Pa_s", {1e-6, 1e4, "Pa s"});
    params.viscosity_ratio = section.number("viscosity_ratio", {1e-12, 1.0, "post- / pre-yield"});
    params.yield_coefficient =
        section.number("yield_coefficient", {0.0, 1e6, "Pa per (A/m)^yield_exponent"});
    params.yield_exponent = section.number("yield_exponent", {0.1, 4.0, "-"}, 1.0);
    params.coil_turns = section.number("coil_turns", {1.0, 1e6, "turns"});
    params.coil_radius_m = section.number("coil_radius_m", {1e-4, 10.0, "m"});
    params.force_scale = section.number("force_scale", {0.0, 1e6, "-"}, 1.0);
    if (params.min_gap_m >= params.gap_m) {
        section.fail("min_gap_m", "expected less than gap_m");
    }
    return std::make_shared<SqueezeBiviscosity>(params);
}

std::shared_ptr<const Damper> read_viscous(TomlTable &section) {
    ViscousParams params{};
    params.base_N_s_m = section.number("base_N_s_m", {0.0, 1e9, "N s/m"});
    params.per_A_N_s_m = section.number("per_A_N_s_m", {0.0, 1e9, "N s/m per A"});
    params.stroke_m = section.number("stroke_m", {1e-9, 100.0, "m"});
    return std::make_shared<Viscous>(params);
}

std::shared_ptr<const Damper> read_switched_stiffness(TomlTable &section) {
    SwitchedStiffnessParams params{};
    params.base_N_s_m = section.number("base_N_s_m", {0.0, 1e9, "N s/m"});
    params.per_A_N_s_m = section.number("per_A_N_s_m", {0.0, 1e9, "N s/m per A"});
    params.base_N_m = section.number("base_N_m", {0.0, 1e9, "N/m"});
    params.per_A_N_m = section.number("per_A_N_m", {0.0, 1e9, "N/m per A"});
    params.stroke_m = section.number("stroke_m", {1e-9, 100.0, "m"});
    return std::make_shared<SwitchedStiffness>(params);
}

struct Model {
    const char *name;
    std::shared_ptr<const Damper> (*read)(TomlTable &section);
};

const Model kModels[] = {
    {"squeeze_biviscosity", read_squeeze_biviscosity},
    {"switched_stiffness", read_switched_stiffness},
    {"viscous", read_viscous},
};

} // namespace

std::shared_ptr<const Damper> read_damper(TomlTable section) {
    std::vector<std::string> names;
    for (const Model &model : kModels) {
        names.emplace_back(model.name);
    }
    const std::string chosen = section.choice("model", names);
    std::shared_ptr<const Damper> damper;
    for (const Model &model : kModels) {
        if (chosen == model.name) {
            damper = model.read(section);
        }
    }
    section.reject_unknown_keys();
    return damper;
}

} // namespace quiesce
