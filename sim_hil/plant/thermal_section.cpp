#include "thermal_section.h"

#include <algorithm>

namespace quiesce {

std::optional<Thermal> read_thermal(TomlTable &section) {
    std::optional<TomlTable> keys = section.optional_table("thermal");
    if (!keys) {
        return {};
    }
    constexpr Range kTemperature{-100.0, 300.0, "C"};
    constexpr double kRoom_C = 25.0;
    Thermal out{};
    out.heat.heat_capacity_J_K = keys->number("heat_capacity_J_K", {1e-3, 1e9, "J/K"});
    out.heat.conductance_W_K = keys->number("conductance_W_K", {0.0, 1e6, "W/K"});
    out.heat.ambient_C = keys->number("ambient_C", kTemperature, kRoom_C);
    out.heat.start_C = keys->number("start_C", kTemperature, out.heat.ambient_C);
    out.heat.coil_ohm = keys->number("coil_ohm", {0.0, 1e4, "ohm"}, 0.0);
    out.law.activation_K = keys->number("activation_K", {0.0, 1e5, "K"}, 0.0);
    out.law.yield_1_K = keys->number("yield_1_K", {0.0, 1.0, "1/K"}, 0.0);
    out.law.reference_C = keys->number("reference_C", kTemperature, kRoom_C);
    out.law.coldest_C = std::min(out.heat.ambient_C, out.heat.start_C);
    keys->reject_unknown_keys();
    return out;
}

void require_followed(TomlTable &section, const FluidLaw &law, bool has_viscous,
                      bool has_yielding) {
    const auto require = [&](bool is_there, double value, const char *key, const char *what) {
        if (value > 0.0 && !is_there) {
            section.table("thermal").fail(key, std::string("this model has no ") + what +
                                                   " that it could act on; leave it out");
        }
    };
    require(has_viscous, law.activation_K, "activation_K", "parameter in N s/m");
    require(has_yielding, law.yield_1_K, "yield_1_K", "yield force in N");
}

} // namespace quiesce
