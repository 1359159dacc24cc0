#include "dampers_section.h"

#include <algorithm>
#include <optional>
#include <sstream>

#include "damper_section.h"
#include "identifier.h"
#include "place_section.h"

namespace quiesce {

namespace {

/// What all dampers of a file have in common.
struct Shared {
    TomlTable &root;
    const PlantModel &model;
    std::optional<CoilParams> coil; ///< [coil]
};

/// The part of a range that tells rounding from a driver that is too large.
constexpr double kRounding = 1.001;

void check_current(const Shared &shared, const DamperChoice &choice, const PlantDamper &damper) {
    const double full_A = shared.model.driver.max_current_A;
    if (choice.max_current_A && full_A > kRounding * *choice.max_current_A) {
        std::ostringstream message;
        message << full_A << " is beyond the " << *choice.max_current_A << " up to which the file"
                << " of the " << label(damper) << " holds; lower it, or widen [valid] there";
        shared.root.table("driver").fail("max_current_A", message.str());
    }
}

/// Its own coil, the plant's, or that of its file.
CoilParams coil_of(Shared &shared, std::optional<TomlTable> own, const DamperChoice &choice) {
    if (own) {
        return read_coil(*own);
    }
    if (shared.coil || choice.coil) {
        return shared.coil ? *shared.coil : *choice.coil;
    }
    return read_coil(shared.root.table("coil")); // which is missing
}

PlantDamper read_one(Shared &shared, const TomlTable &section, std::optional<TomlTable> own_coil,
                     PlantDamper damper) {
    const DamperChoice choice = read_damper(section);
    damper.damper = choice.damper;
    check_current(shared, choice, damper);
    damper.coil = coil_of(shared, std::move(own_coil), choice);
    if (choice.is_warmed_by_coil && damper.coil.remanence > 0.0) {
        section.fail("thermal", "coil_ohm needs the coil's current, and with coil.remanence the "
                                "damper sees another one; leave one of the two out");
    }
    return damper;
}

/// Ground does not move: displacements are relative to the base.
Eigen::VectorXd shape_of(const PlantModel &model, const std::string &name) {
    for (const Place &place : model.places) {
        if (place.name == name) {
            return place.shape;
        }
    }
    return Eigen::VectorXd::Zero(model.structure.mode_count());
}

double read_ratio(TomlTable &section) {
    return section.number("ratio", {0.01, 100.0, "-"}, 1.0);
}

/// [damper], where the structure says.
PlantDamper read_only(Shared &shared, TomlTable section, const Eigen::VectorXd &at_damper) {
    const double ratio = read_ratio(section);
    return read_one(shared, section, std::nullopt,
                    {kOnlyDamper, nullptr, ratio * at_damper, {}, ratio});
}

PlantDamper read_joined(Shared &shared, TomlTable &section, const std::vector<std::string> &taken) {
    PlantDamper damper{};
    damper.name = read_name(section, taken);
    damper.ratio = read_ratio(section);
    damper.stroke = damper.ratio * read_stroke(section, shared.model);
    std::optional<TomlTable> coil = section.optional_table("coil");
    return read_one(shared, section, std::move(coil), std::move(damper));
}

std::vector<PlantDamper> read_several(Shared &shared) {
    std::vector<TomlTable> sections = shared.root.tables("damper");
    if (sections.size() > kMaxDampers) {
        shared.root.fail("damper", "expected at most " + std::to_string(kMaxDampers) +
                                       " tables [[damper]], found " +
                                       std::to_string(sections.size()));
    }
    std::vector<PlantDamper> dampers;
    std::vector<std::string> taken;
    for (TomlTable &section : sections) {
        dampers.push_back(read_joined(shared, section, taken));
        taken.push_back(dampers.back().name);
    }
    return dampers;
}

} // namespace

bool has_damper_ends(const TomlTable &root) {
    return root.is_array("damper");
}

Eigen::VectorXd read_stroke(TomlTable &section, const PlantModel &model) {
    std::vector<std::string> names = {kGround};
    for (const Place &place : model.places) {
        names.push_back(place.name);
    }
    const std::string a = section.choice("a", names);
    const std::string b = section.choice("b", names);
    if (a == b) {
        section.fail("b", "expected another end than a, found '" + b + "'");
    }
    Eigen::VectorXd stroke = shape_of(model, a) - shape_of(model, b);
    if (stroke.isZero(0.0)) {
        section.fail("b", a + " and " + b + " move alike, so there is no stroke between them");
    }
    return stroke;
}

void read_dampers(TomlTable &root, const Eigen::VectorXd &at_damper, PlantModel &model) {
    Shared shared{root, model, {}};
    if (std::optional<TomlTable> coil = root.optional_table("coil")) {
        shared.coil = read_coil(*coil);
    }
    if (has_damper_ends(root)) {
        model.dampers = read_several(shared);
    } else {
        model.dampers = {read_only(shared, root.table("damper"), at_damper)};
    }
}

} // namespace quiesce
