#include "structure_section.h"

#include "input_error.h"

namespace quiesce {

namespace {

constexpr std::size_t kMaxDegrees = 64;
constexpr Range kShape = {-1e6, 1e6, "kg^-1/2"};

/// Where the dampers' ends say it, this key would say it twice.
void refuse_damper(const TomlTable &section, const std::string &key) {
    if (section.has(key)) {
        section.fail(key, "with [[damper]] the ends a and b say where a damper is; leave it out");
    }
}

Mode read_mode(TomlTable &table, bool has_ends, std::vector<double> &at_damper) {
    Mode mode{};
    mode.freq_Hz = table.number("freq_Hz", {1e-3, 1e4, "Hz"});
    mode.damping_ratio = table.number("damping_ratio", {0.0, 2.0, "-"});
    mode.at_force = table.number("at_force", kShape);
    if (has_ends) {
        refuse_damper(table, "at_damper");
    } else {
        at_damper.push_back(table.number("at_damper", kShape));
    }
    mode.at_sensor = table.number("at_sensor", kShape);
    mode.base_participation = table.number("base_participation", {-1e6, 1e6, "kg^1/2"}, 0.0);
    table.reject_unknown_keys();
    return mode;
}

Eigen::VectorXd vector_of(const std::vector<double> &numbers) {
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                             static_cast<Eigen::Index>(numbers.size()));
}

StructureSection read_modes(TomlTable &section, bool has_ends) {
    std::vector<Mode> modes;
    std::vector<double> at_damper;
    for (TomlTable &table : section.tables("mode")) {
        modes.push_back(read_mode(table, has_ends, at_damper));
    }
    if (modes.empty() || modes.size() > kMaxDegrees) {
        section.fail("mode",
                     "expected 1 .. " + std::to_string(kMaxDegrees) + " tables [[structure.mode]]");
    }
    return {structure_from_modes(modes), vector_of(at_damper)};
}

Eigen::VectorXd read_vector(TomlTable &section, const std::string &key, std::size_t count) {
    return vector_of(section.numbers(key, count));
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

/// The matrices and vectors but for the damper's.
Matrices read_degrees(TomlTable &section, std::size_t count) {
    Matrices matrices;
    matrices.force = read_vector(section, "force", count);
    matrices.sensor = read_vector(section, "sensor", count);
    matrices.base = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(count));
    if (section.has("base")) {
        matrices.base = read_vector(section, "base", count);
    }
    matrices.mass_kg = read_matrix(section, "mass_kg", count);
    matrices.damping_N_s_m = read_matrix(section, "damping_N_s_m", count);
    matrices.stiffness_N_m = read_matrix(section, "stiffness_N_m", count);
    return matrices;
}

/// Of the only damper; empty where dampers have ends.
Eigen::VectorXd read_damper(TomlTable &section, bool has_ends, std::size_t count) {
    if (has_ends) {
        refuse_damper(section, "damper");
        return {};
    }
    return read_vector(section, "damper", count);
}

StructureSection read_matrices(TomlTable &section, bool has_ends) {
    const std::size_t count = section.numbers("force", 0).size();
    if (count > kMaxDegrees) {
        section.fail("force", "expected at most " + std::to_string(kMaxDegrees) + " numbers");
    }
    const Matrices matrices = read_degrees(section, count);
    const Eigen::VectorXd damper = read_damper(section, has_ends, count);
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t mode_count = section.integer("mode_count", 1, size, size);
    try {
        Structure structure =
            structure_from_matrices(matrices, static_cast<Eigen::Index>(mode_count));
        Eigen::VectorXd at_damper = has_ends ? damper : structure.shape_of(damper);
        return {std::move(structure), std::move(at_damper)};
    } catch (const InputError &error) {
        const std::string what = error.what();
        const std::size_t colon = what.find(": ");
        section.fail(what.substr(0, colon), what.substr(colon + 2));
    }
}

} // namespace

StructureSection read_structure(TomlTable section, bool has_ends) {
    const std::string kind = section.choice("kind", {"modes", "matrices"});
    StructureSection out =
        kind == "modes" ? read_modes(section, has_ends) : read_matrices(section, has_ends);
    section.reject_unknown_keys();
    return out;
}

} // namespace quiesce
