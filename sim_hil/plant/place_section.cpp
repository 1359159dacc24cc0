#include "place_section.h"

#include <algorithm>

#include "identifier.h"
#include "plant_model.h"

namespace quiesce {

namespace {

constexpr Range kBase = {-1e6, 1e6, "of the base's motion"};

Place read_place(TomlTable &table, const Structure &structure,
                 const std::vector<std::string> &taken) {
    Place place;
    place.name = read_name(table, taken);
    const std::vector<double> numbers =
        table.numbers("at", static_cast<std::size_t>(structure.shapes.rows()));
    const Eigen::Map<const Eigen::VectorXd> at(numbers.data(), structure.shapes.rows());
    place.shape = structure.shape_of(at);
    // The matrices say how their degrees of freedom move with the base, the modes do not.
    place.base =
        structure.base.size() > 0 ? at.dot(structure.base) : table.number("base", kBase, 1.0);
    table.reject_unknown_keys();
    return place;
}

} // namespace

std::string read_name(TomlTable &section, const std::vector<std::string> &taken) {
    std::string name = section.text("name");
    require_identifier(section, "name", name);
    if (std::find(taken.begin(), taken.end(), name) != taken.end()) {
        section.fail("name", "expected a name that nothing else has, found '" + name + "'");
    }
    return name;
}

std::vector<Place> read_places(TomlTable &root, const Structure &structure,
                               std::vector<Place> nodes) {
    std::vector<Place> places = std::move(nodes);
    std::vector<std::string> taken = {kGround};
    for (const Place &node : places) {
        taken.push_back(node.name);
    }
    std::vector<TomlTable> tables = root.tables("place");
    for (TomlTable &table : tables) {
        places.push_back(read_place(table, structure, taken));
        taken.push_back(places.back().name);
    }
    if (tables.size() > kMaxPlaces) {
        root.fail("place", "expected at most " + std::to_string(kMaxPlaces) +
                               " tables [[place]], found " + std::to_string(tables.size()));
    }
    return places;
}

} // namespace quiesce
