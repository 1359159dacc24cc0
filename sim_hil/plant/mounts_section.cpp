#include "mounts_section.h"

#include "dampers_section.h"
#include "mounts.h"

namespace quiesce {

namespace {

constexpr Range kLength = {0.0, 100.0, "m"};
constexpr Range kStiffness = {0.0, 1e9, "N/m"};
constexpr Range kDamping = {0.0, 1e9, "N s/m"};
constexpr Range kForce = {1e-9, 1e9, "N"};

std::shared_ptr<const Mount> read_law(TomlTable &section) {
    const std::string kind = section.choice("kind", {"gap", "softening", "contact"});
    if (kind == "contact") {
        const double stiffness_N_m = section.number("stiffness_N_m", kStiffness);
        const double damping_N_s_m = section.number("damping_N_s_m", kDamping, 0.0);
        return std::make_shared<ContactMount>(stiffness_N_m, damping_N_s_m,
                                              section.number("preload_N", kForce));
    }
    if (kind == "gap") {
        const double gap_m = section.number("gap_m", kLength);
        const double stiffness_N_m = section.number("stiffness_N_m", kStiffness);
        return std::make_shared<GappedMount>(gap_m, stiffness_N_m,
                                             section.number("damping_N_s_m", kDamping, 0.0));
    }
    const double stiffness_N_m = section.number("stiffness_N_m", kStiffness);
    return std::make_shared<SofteningMount>(stiffness_N_m, section.number("limit_N", kForce));
}

} // namespace

void read_mounts(TomlTable &root, PlantModel &model) {
    std::vector<TomlTable> sections = root.tables("mount");
    if (sections.size() > kMaxMounts) {
        root.fail("mount", "expected at most " + std::to_string(kMaxMounts) +
                               " tables [[mount]], found " + std::to_string(sections.size()));
    }
    for (TomlTable &section : sections) {
        PlantMount one;
        one.stroke = read_stroke(section, model);
        one.mount = read_law(section);
        section.reject_unknown_keys();
        model.mounts.push_back(std::move(one));
    }
}

} // namespace quiesce
