#include "structure_section.h"

#include "input_error.h"

namespace quiesce {

namespace {

constexpr std::size_t kMaxDegrees = 64;
constexpr Range kShape = {-1e6, 1e6, "kg^-1/2"};

Structure read_modes(TomlTable &section) {
    std::vector<Mode> modes;
    for (TomlTable &table : section.tables("mode")) {
        Mode mode{};
        mode.freq_Hz = table.number("freq_Hz", {1e-3, 1e4, "Hz"});
        mode.damping_ratio = table.number("damping_ratio", {0.0, 2.0, "-"});
        mode.at_force = table.number("at_force", kShape);
        mode.at_damper = table.number("at_damper", kShape);
        mode.at_sensor = table.number("at_sensor", kShape);
        mode.base_participation = table.number("base_participation", {-1e6, 1e6, "kg^1/2"}, 0.0);
        table.reject_unknown_keys();
        modes.push_back(mode);
    }
    if (modes.empty() || modes.size() > kMaxDegrees) {
        section.fail("mode",
                     "expected 1 .. " + std::to_string(kMaxDegrees) + " tables [[structure.mode]]");
    }
    return structure_from_modes(modes);
}

Eigen::VectorXd read_vector(TomlTable &section, const std::string &key, std::size_t count) {
    const std::vector<double> numbers = section.numbers(key, count);
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(count));
}

Eigen::MatrixXd read_matrix(TomlTable &section, const std::string &key, std::size_t count) {
    const std::vector<std::vector<double>> rows = section.square(key, count);
    const auto size = static_cast<Eigen::Index>(count);
    Eigen::MatrixXd out(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
        out.row(i) =
            Eigen::Map<const Eigen::RowVectorXd>(rows[static_cast<std::size_t>(i)].data(), size);
    }
    return out;
}

Structure read_matrices(TomlTable &section) {
    const std::size_t count = section.numbers("force", 0).size();
    if (count > kMaxDegrees) {
        section.fail("force", "expected at most " + std::to_string(kMaxDegrees) + " numbers");
    }
    Matrices matrices;
    matrices.force = read_vector(section, "force", count);
    matrices.damper = read_vector(section, "damper", count);
    matrices.sensor = read_vector(section, "sensor", count);
    matrices.base = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(count));
    if (section.has("base")) {
        matrices.base = read_vector(section, "base", count);
    }
    matrices.mass_kg = read_matrix(section, "mass_kg", count);
    matrices.damping_N_s_m = read_matrix(section, "damping_N_s_m", count);
    matrices.stiffness_N_m = read_matrix(section, "stiffness_N_m", count);
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t mode_count = section.integer("mode_count", 1, size, size);
    try {
        return structure_from_matrices(matrices, static_cast<Eigen::Index>(mode_count));
    } catch (const InputError &error) {
        const std::string what = error.what();
        const std::size_t colon = what.find(": ");
        section.fail(what.substr(0, colon), what.substr(colon + 2));
    }
}

} // namespace

Structure read_structure(TomlTable section) {
    const std::string kind = section.choice("kind", {"modes", "matrices"});
    Structure structure = kind == "modes" ? read_modes(section) : read_matrices(section);
    section.reject_unknown_keys();
    return structure;
}

} // namespace quiesce
