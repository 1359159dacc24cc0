#include "damper_section.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "accel_estimate.h"
#include "elastomer.h"
#include "input_error.h"
#include "kernel_models.h"
#include "learned_section.h"
#include "squeeze_biviscosity.h"
#include "switched_stiffness.h"
#include "thermal_section.h"
#include "viscous.h"

namespace quiesce {

namespace {

std::shared_ptr<const Damper> read_squeeze_biviscosity(TomlTable &section, const FluidLaw &fluid) {
    SqueezeBiviscosityParams params{};
    params.plate_radius_m = section.number("plate_radius_m", {1e-4, 1.0, "m"});
    params.gap_m = section.number("gap_m", {1e-6, 0.1, "m"});
    params.min_gap_m = section.number("min_gap_m", {1e-9, 0.1, "m"}, kFilmLeastGap * params.gap_m);
    params.viscosity_Pa_s = section.number("viscosity_Pa_s", {1e-6, 1e4, "Pa s"});
    params.viscosity_ratio = section.number("viscosity_ratio", {1e-12, 1.0, "post- / pre-yield"});
    params.yield_coefficient =
        section.number("yield_coefficient", {0.0, 1e6, "Pa per (A/m)^yield_exponent"});
    params.yield_exponent = section.number("yield_exponent", {0.1, 4.0, "-"}, 1.0);
    params.coil_turns = section.number("coil_turns", {1.0, 1e6, "turns"});
    params.coil_radius_m = section.number("coil_radius_m", {1e-4, 10.0, "m"});
    params.force_scale = section.number("force_scale", {0.0, 1e6, "-"}, 1.0);
    params.fluid = fluid;
    if (params.min_gap_m >= params.gap_m) {
        section.fail("min_gap_m", "expected less than gap_m");
    }
    return std::make_shared<SqueezeBiviscosity>(params);
}

std::shared_ptr<const Damper> read_viscous(TomlTable &section, const FluidLaw & /*fluid*/) {
    ViscousParams params{};
    params.base_N_s_m = section.number("base_N_s_m", {0.0, 1e9, "N s/m"});
    params.per_A_N_s_m = section.number("per_A_N_s_m", {0.0, 1e9, "N s/m per A"});
    params.stroke_m = section.number("stroke_m", {1e-9, 100.0, "m"});
    return std::make_shared<Viscous>(params);
}

std::shared_ptr<const Damper> read_switched_stiffness(TomlTable &section,
                                                      const FluidLaw & /*fluid*/) {
    SwitchedStiffnessParams params{};
    params.base_N_s_m = section.number("base_N_s_m", {0.0, 1e9, "N s/m"});
    params.per_A_N_s_m = section.number("per_A_N_s_m", {0.0, 1e9, "N s/m per A"});
    params.base_N_m = section.number("base_N_m", {0.0, 1e9, "N/m"});
    params.per_A_N_m = section.number("per_A_N_m", {0.0, 1e9, "N/m per A"});
    params.stroke_m = section.number("stroke_m", {1e-9, 100.0, "m"});
    return std::make_shared<SwitchedStiffness>(params);
}

std::shared_ptr<const Damper> read_elastomer(TomlTable &section, const FluidLaw & /*fluid*/) {
    ElastomerParams params{};
    params.area_m2 = section.number("area_m2", {1e-9, 1e3, "m2"});
    params.thickness_m = section.number("thickness_m", {1e-6, 10.0, "m"});
    const std::vector<double> storage_MPa = section.numbers("storage_MPa", 3);
    std::copy(storage_MPa.begin(), storage_MPa.end(), params.storage_MPa.begin());
    if (storage_MPa[0] <= 0.0 || storage_MPa[1] < 0.0) {
        section.fail("storage_MPa", "expected a modulus above 0 that does not fall with the first "
                                    "ampere: [MPa, MPa/A, MPa/A^2]");
    }
    params.loss_factor = section.number("loss_factor", {0.0, 10.0, "-"});
    params.loss_freq_Hz = section.number("loss_freq_Hz", {1e-3, 1e5, "Hz"});
    params.stroke_m = section.number("stroke_m", {1e-9, 100.0, "m"});
    return std::make_shared<Elastomer>(params);
}

/// A model with a class of its own; where there is a kernel of the same name, a plant takes the
/// class.
struct Model {
    const char *name;
    std::shared_ptr<const Damper> (*read)(TomlTable &keys, const FluidLaw &fluid);
    bool has_film; ///< whose force falls as it warms up
};

const Model kModels[] = {
    {"elastomer", read_elastomer, false},
    {"squeeze_biviscosity", read_squeeze_biviscosity, true},
    {"switched_stiffness", read_switched_stiffness, false},
    {"viscous", read_viscous, false},
};

std::vector<std::string> model_names() {
    std::vector<std::string> names;
    for (const Model &model : kModels) {
        names.emplace_back(model.name);
    }
    for (const KernelModel &model : kernel_models()) {
        names.emplace_back(model.name);
    }
    for (const LearnedModel &model : learned_models()) {
        names.emplace_back(model.name);
    }
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

CurrentLaw read_law(TomlTable &keys, const ParameterInfo &info) {
    const std::vector<double> values =
        keys.coefficients(info.name, 3, {info.min, info.max, info.unit});
    CurrentLaw law{};
    std::copy(values.begin(), values.end(), law.begin());
    return law;
}

MotionLimits read_limits(TomlTable &section) {
    return {section.number("stroke_m", {1e-9, 100.0, "m"}),
            section.number("speed_m_s", {1e-9, 1000.0, "m/s"})};
}

/// Keys in [parameters], as in damper files, or beside "model".
std::shared_ptr<const Damper> read_class(const Model &model, TomlTable &section,
                                         const FluidLaw &fluid) {
    require_followed(section, fluid, model.has_film, model.has_film);
    if (!section.has("parameters")) {
        return model.read(section, fluid);
    }
    for (const char *key : {"stroke_m", "speed_m_s"}) {
        section.accept(key); // of the recording that it was identified from
    }
    TomlTable keys = section.table("parameters");
    std::shared_ptr<const Damper> damper = model.read(keys, fluid);
    keys.reject_unknown_keys();
    return damper;
}

std::shared_ptr<const Damper> read_learned(const LearnedModel &model, TomlTable &section) {
    const LearnedContext context{read_limits(section), read_damper_model};
    TomlTable keys = section.table("parameters");
    std::shared_ptr<const Damper> damper = model.read(keys, context);
    keys.reject_unknown_keys();
    return damper;
}

FieldLaw<double> read_field(TomlTable &section) {
    std::optional<TomlTable> keys = section.optional_table("field");
    if (!keys) {
        return {};
    }
    FieldLaw<double> field{};
    field.exponent = keys->number("exponent", {0.05, 20.0, "-"});
    field.saturation = keys->number("saturation", {0.0, 1e6, "-"}, 0.0);
    field.reference = keys->number("reference_A", {1e-6, 1e6, "A"});
    keys->reject_unknown_keys();
    return field;
}

std::shared_ptr<const Damper> read_kernel(const KernelModel &model, TomlTable &section,
                                          const FluidLaw &fluid) {
    const ParameterInfo *end = model.parameters + model.parameter_count;
    require_followed(section, fluid, std::any_of(model.parameters, end, is_viscous),
                     std::any_of(model.parameters, end, is_yielding));
    const MotionLimits limits = read_limits(section);
    TomlTable keys = section.table("parameters");
    std::vector<CurrentLaw> laws;
    for (std::size_t k = 0; k < model.parameter_count; ++k) {
        laws.push_back(read_law(keys, model.parameters[k]));
    }
    keys.reject_unknown_keys();
    return model.make(laws.data(), limits.stroke_m, limits.speed_m_s, read_field(section), fluid);
}

/// Where a damper file says that it holds: [valid].
void read_validity(TomlTable valid, DamperChoice &choice) {
    choice.is_usable = valid.boolean("usable", true);
    for (const char *key : {"current_A", "command_V"}) {
        if (valid.has(key)) {
            const std::vector<double> range = valid.numbers(key, 0);
            choice.max_current_A = range.back();
            choice.is_in_volts = std::string(key) == "command_V";
        }
    }
}

/// A plant must not use a set that is marked unusable, nor take amperes for volts unknowingly.
void check_for_plant(TomlTable &section, const DamperChoice &choice) {
    if (!choice.is_usable) {
        section.fail("file", "this set is marked as not usable ([valid] in it says why)");
    }
    const bool has_unit = section.has("command_unit");
    const std::string unit = has_unit ? section.choice("command_unit", {"A", "V"}) : "A";
    if (choice.is_in_volts != (unit == "V")) {
        section.fail(has_unit ? "command_unit" : "file",
                     choice.is_in_volts
                         ? "its command is a voltage; let the plant's driver be one of volts and "
                           "say command_unit = \"V\""
                         : "its command is a current, not a voltage");
    }
}

DamperChoice with_accel_estimate(DamperChoice choice) {
    if (choice.damper->uses_accel()) {
        choice.damper = std::make_shared<AccelEstimate>(choice.damper);
    }
    return choice;
}

std::shared_ptr<const Damper> read_any(TomlTable &section, const FluidLaw &fluid) {
    const std::string chosen = section.choice("model", model_names());
    for (const Model &model : kModels) {
        if (chosen == model.name) {
            return read_class(model, section, fluid);
        }
    }
    for (const KernelModel &model : kernel_models()) {
        if (chosen == model.name) {
            return read_kernel(model, section, fluid);
        }
    }
    const std::vector<LearnedModel> &learned = learned_models();
    // What the temperature does to its force it has learned.
    require_followed(section, fluid, false, false);
    return read_learned(*std::find_if(learned.begin(), learned.end(),
                                      [&](const auto &one) { return chosen == one.name; }),
                        section);
}

/// The model and, where there is one, its [thermal].
void read_own(TomlTable &section, DamperChoice &choice) {
    const std::optional<Thermal> thermal = read_thermal(section);
    choice.damper = read_any(section, thermal ? thermal->law : FluidLaw{});
    if (thermal) {
        choice.damper = std::make_shared<WarmDamper>(choice.damper, thermal->heat);
        choice.is_warmed_by_coil = thermal->heat.coil_ohm > 0.0;
    }
}

/// What is wrong in a damper's file stands behind the section that names it: a plant has several.
DamperChoice load_named(TomlTable &section) {
    const std::string file = section.path("file");
    try {
        return load_damper(file);
    } catch (const InputError &error) {
        section.fail("file", error.what());
    }
}

} // namespace

std::shared_ptr<const Damper> read_damper_model(TomlTable &section) {
    return read_any(section, {});
}

CoilParams read_coil(TomlTable section) {
    CoilParams params{};
    params.rise_s = section.number("rise_s", {0.0, 10.0, "s"});
    params.fall_s = section.number("fall_s", {0.0, 10.0, "s"}, params.rise_s);
    params.remanence = section.number("remanence", {0.0, 0.5, "of driver.max_current_A"}, 0.0);
    section.reject_unknown_keys();
    return params;
}

DamperChoice read_damper(TomlTable section) {
    DamperChoice choice;
    if (section.has("file")) {
        choice = load_named(section);
        check_for_plant(section, choice);
    } else {
        read_own(section, choice);
    }
    section.reject_unknown_keys();
    return with_accel_estimate(choice);
}

DamperChoice load_damper(const std::string &file) {
    const TomlFile toml(file, "quiesce-damper", 1);
    TomlTable root = toml.root();
    root.text("schema");
    root.integer("version", 1, 1);
    root.text("name");
    DamperChoice choice;
    read_own(root, choice);
    if (std::optional<TomlTable> coil = root.optional_table("coil")) {
        choice.coil = read_coil(*coil);
    }
    // For people and for other readers: where it comes from, where it holds, the rig it was on.
    if (std::optional<TomlTable> valid = root.optional_table("valid")) {
        read_validity(*valid, choice);
    }
    for (const char *key : {"source", "rig", "fit"}) {
        root.accept(key);
    }
    root.reject_unknown_keys();
    return choice;
}

} // namespace quiesce
