#include "structure_section.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "csv_columns.h"
#include "identifier.h"
#include "input_error.h"

namespace quiesce {

namespace {

constexpr std::size_t kMaxDegrees = 64;
constexpr std::size_t kMaxNodes = 16;
constexpr Range kShape = {-1e6, 1e6, "kg^-1/2"};

/// Where the dampers' ends say it, this key would say it twice.
void refuse_damper(const TomlTable &section, const std::string &key) {
    if (section.has(key)) {
        section.fail(key, "with [[damper]] the ends a and b say where a damper is; leave it out");
    }
}

/// All but its shape.
Mode read_oscillator(TomlTable &table) {
    Mode mode{};
    mode.freq_Hz = table.number("freq_Hz", {1e-3, 1e4, "Hz"});
    mode.damping_ratio = table.number("damping_ratio", {0.0, 2.0, "-"});
    mode.base_participation = table.number("base_participation", {-1e6, 1e6, "kg^1/2"}, 0.0);
    return mode;
}

Mode read_mode(TomlTable &table, bool has_ends, std::vector<double> &at_damper) {
    Mode mode = read_oscillator(table);
    mode.at_force = table.number("at_force", kShape);
    if (has_ends) {
        refuse_damper(table, "at_damper");
    } else {
        at_damper.push_back(table.number("at_damper", kShape));
    }
    mode.at_sensor = table.number("at_sensor", kShape);
    table.reject_unknown_keys();
    return mode;
}

Eigen::VectorXd vector_of(const std::vector<double> &numbers) {
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                             static_cast<Eigen::Index>(numbers.size()));
}

std::vector<TomlTable> mode_tables(TomlTable &section) {
    std::vector<TomlTable> tables = section.tables("mode");
    if (tables.empty() || tables.size() > kMaxDegrees) {
        section.fail("mode",
                     "expected 1 .. " + std::to_string(kMaxDegrees) + " tables [[structure.mode]]");
    }
    return tables;
}

StructureSection read_modes(TomlTable &section, bool has_ends) {
    std::vector<Mode> modes;
    std::vector<double> at_damper;
    for (TomlTable &table : mode_tables(section)) {
        modes.push_back(read_mode(table, has_ends, at_damper));
    }
    return {structure_from_modes(modes), vector_of(at_damper), {}};
}

// Modes over nodes

std::vector<std::string> read_node_names(TomlTable &section) {
    std::vector<std::string> names = section.texts("nodes");
    if (names.size() > kMaxNodes) {
        section.fail("nodes", "expected at most " + std::to_string(kMaxNodes) + " names");
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        require_identifier(section, "nodes", names[i]);
        if (std::count(names.begin(), names.end(), names[i]) > 1 || names[i] == kGround) {
            section.fail("nodes", "expected names that differ, and none of them '" +
                                      std::string(kGround) + "'; found '" + names[i] + "'");
        }
    }
    return names;
}

/// A row of the shapes, by the name of its node.
Eigen::VectorXd at_node(TomlTable &section, const std::string &key,
                        const std::vector<std::string> &nodes, const Eigen::MatrixXd &shapes) {
    const std::string name = section.choice(key, nodes);
    return shapes.row(std::find(nodes.begin(), nodes.end(), name) - nodes.begin());
}

/// Modes without shapes, and their shapes [node x mode].
std::vector<Mode> read_shapes(TomlTable &section, std::size_t nodes, Eigen::MatrixXd &shapes) {
    std::vector<TomlTable> tables = mode_tables(section);
    std::vector<Mode> modes;
    shapes.resize(static_cast<Eigen::Index>(nodes), static_cast<Eigen::Index>(tables.size()));
    for (TomlTable &table : tables) {
        const Eigen::VectorXd shape = vector_of(table.numbers("shape", nodes));
        if (shape.isZero(0.0) || shape.cwiseAbs().maxCoeff() > kShape.max) {
            table.fail("shape", "expected one that moves some node, at most 1e6 kg^-1/2");
        }
        shapes.col(static_cast<Eigen::Index>(modes.size())) = shape;
        modes.push_back(read_oscillator(table));
        table.reject_unknown_keys();
    }
    return modes;
}

StructureSection read_nodes(TomlTable &section, bool has_ends) {
    const std::vector<std::string> names = read_node_names(section);
    Eigen::MatrixXd shapes;
    const std::vector<Mode> modes = read_shapes(section, names.size(), shapes);
    StructureSection out{structure_from_modes(modes), {}, {}};
    out.structure.at_force = at_node(section, "force", names, shapes);
    out.structure.at_sensor = at_node(section, "sensor", names, shapes);
    if (has_ends) {
        refuse_damper(section, "damper");
    } else {
        out.at_damper = at_node(section, "damper", names, shapes);
    }
    out.structure.shapes = shapes;
    out.structure.base = Eigen::VectorXd::Ones(shapes.rows());
    for (std::size_t i = 0; i < names.size(); ++i) {
        out.nodes.push_back({names[i], shapes.row(static_cast<Eigen::Index>(i)), 1.0});
    }
    return out;
}

// Matrices

Eigen::VectorXd read_vector(TomlTable &section, const std::string &key, std::size_t count) {
    return vector_of(section.numbers(key, count));
}

/// Of a CSV file without a header, by its path from the plant's.
std::vector<std::vector<double>> rows_of_file(TomlTable &section, const std::string &key,
                                              std::size_t count) {
    const std::string file = section.path(key);
    std::vector<std::vector<double>> rows;
    for (CsvRow &row : read_csv_numbers(file)) {
        if (row.values.size() != count) {
            std::ostringstream message;
            message << file << ':' << row.line << ": expected " << count << " numbers, found "
                    << row.values.size();
            throw InputError(message.str());
        }
        rows.push_back(std::move(row.values));
    }
    if (rows.size() != count) {
        std::ostringstream message;
        message << "expected " << count << " lines of " << count
                << " numbers, as many as force has; found " << rows.size() << " lines";
        section.fail(key, message.str());
    }
    return rows;
}

/// Under its key, or in the file that the key with _file names.
Eigen::MatrixXd read_matrix(TomlTable &section, const std::string &key, std::size_t count) {
    const std::string of_file = key + "_file";
    if (section.has(key) && section.has(of_file)) {
        section.fail(of_file, key + " is there, too; leave one of the two out");
    }
    const std::vector<std::vector<double>> rows =
        section.has(of_file) ? rows_of_file(section, of_file, count) : section.square(key, count);
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
        return {std::move(structure), std::move(at_damper), {}};
    } catch (const InputError &error) {
        const std::string what = error.what();
        const std::size_t colon = what.find(": ");
        section.fail(what.substr(0, colon), what.substr(colon + 2));
    }
}

} // namespace

StructureSection read_structure(TomlTable section, bool has_ends) {
    const std::string kind = section.choice("kind", {"modes", "nodes", "matrices"});
    StructureSection out = kind == "modes"   ? read_modes(section, has_ends)
                           : kind == "nodes" ? read_nodes(section, has_ends)
                                             : read_matrices(section, has_ends);
    section.reject_unknown_keys();
    return out;
}

} // namespace quiesce
