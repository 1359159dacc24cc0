#include "equations.h"

#include <cstddef>

#include "elastomer.h"
#include "field_law.h"
#include "kernels.h"
#include "switched_stiffness.h"
#include "viscous.h"

namespace quiesce {

namespace {

Motion<Traced> named_motion() {
    return {traced_name("x"), traced_name("v"), traced_name("a"), traced_name("i")};
}

template <class Kernel>
ModelEquations equations_of() {
    std::vector<Traced> p;
    for (const ParameterInfo &info : Kernel::kParameters) {
        p.push_back(traced_name(info.name));
    }
    std::vector<Traced> z;
    for (int k = 0; k < Kernel::kStates; ++k) {
        z.push_back(traced_name("z" + std::to_string(k)));
    }
    ModelEquations out{Kernel::kName, {}, std::vector<Traced>(z.size()), {}};
    out.force_N = Kernel::force_N(p.data(), named_motion(), z.data(), out.rates.data());
    out.fastest_rate_1_s = Kernel::fastest_rate_1_s(p.data(), traced_name("speed"));
    return out;
}

ModelEquations plain(const char *name, const Traced &force_N) {
    return {name, force_N, {}, Traced(0.0)};
}

std::vector<std::string> argument_names(std::size_t count) {
    std::vector<std::string> out;
    for (std::size_t k = 0; k < count; ++k) {
        out.emplace_back(1, static_cast<char>('x' + k));
    }
    return out;
}

TracedFunction function_of(const char *name, std::size_t count, const Traced &result) {
    return {name, argument_names(count), result};
}

} // namespace

std::vector<ModelEquations> kernel_equations() {
#define QUIESCE_EQUATIONS_OF(Kernel) equations_of<Kernel>(),
    return {QUIESCE_KERNELS(QUIESCE_EQUATIONS_OF)};
#undef QUIESCE_EQUATIONS_OF
}

std::vector<ModelEquations> plain_equations() {
    const auto named = [](const char *name) { return traced_name(name); };
    const ElastomerLaw<Traced> elastomer{
        named("area_m2"),
        named("thickness_m"),
        {named("storage_MPa0"), named("storage_MPa1"), named("storage_MPa2")},
        named("loss_factor"),
        named("loss_freq_Hz")};
    const SwitchedStiffnessLaw<Traced> switched{named("base_N_s_m"), named("per_A_N_s_m"),
                                                named("base_N_m"), named("per_A_N_m")};
    const ViscousLaw<Traced> viscous{named("base_N_s_m"), named("per_A_N_s_m")};
    return {plain("elastomer", elastomer.force_N(named_motion())),
            plain("switched_stiffness", switched.force_N(named_motion())),
            plain("viscous", viscous.force_N(named_motion()))};
}

TracedFunction field_law_equations() {
    const FieldLaw<Traced> law{traced_name("exponent"), traced_name("saturation"),
                               traced_name("reference")};
    return {
        "effective", {"i", "exponent", "saturation", "reference"}, law.effective(traced_name("i"))};
}

std::vector<TracedFunction> elementary_equations() {
    const Traced x = traced_name("x");
    const Traced y = traced_name("y");
    const Traced z = traced_name("z");
// NOLINTBEGIN(bugprone-macro-parentheses): a template's name takes none
#define QUIESCE_ONE(name) function_of(#name, 1, name<Traced>(x)),
#define QUIESCE_TWO(name) function_of(#name, 2, name<Traced>(x, y)),
#define QUIESCE_THREE(name) function_of(#name, 3, name<Traced>(x, y, z)),
    // NOLINTEND(bugprone-macro-parentheses)
    return {QUIESCE_TRACED_FUNCTIONS(QUIESCE_ONE, QUIESCE_TWO, QUIESCE_THREE)};
#undef QUIESCE_ONE
#undef QUIESCE_TWO
#undef QUIESCE_THREE
}

} // namespace quiesce
