#include "describe.h"

#include <cstdio>
#include <cstring>

#include "json.h"
#include "resources.h"

namespace quiesce {

namespace {

// In the order of the enumerations, as the XML has them.
const char *const kTypes[] = {"real", "integer", "boolean"};
const char *const kCausalities[] = {"parameter", "input", "output"};
const char *const kVariabilities[] = {"fixed", "tunable", "discrete", "continuous"};

Json described(const Variable &variable) {
    return {{"name", variable.name},
            {"type", kTypes[static_cast<int>(variable.type)]},
            {"causality", kCausalities[static_cast<int>(variable.causality)]},
            {"variability", kVariabilities[static_cast<int>(variable.variability)]},
            {"unit", variable.unit},
            {"description", variable.description},
            {"start", variable.start},
            {"min", json_or_null(variable.min)},
            {"max", json_or_null(variable.max)}};
}

std::string description_of(const std::string &resources) {
    const auto model = make_model(read_resources(resources));
    Json variables = Json::array();
    for (const Variable &variable : model->variables()) {
        variables.push_back(described(variable));
    }
    const Json out = {{"tick_s", 1.0 / model->tick_rate_Hz()}, {"variables", variables}};
    return out.dump();
}

} // namespace

} // namespace quiesce

const char *quiesce_fmu_describe(const char *resources, char *error, size_t error_size) {
    try {
        const std::string text = quiesce::description_of(resources);
        char *out = new char[text.size() + 1];
        std::memcpy(out, text.c_str(), text.size() + 1);
        return out;
    } catch (const std::exception &caught) {
        std::snprintf(error, error_size, "%s", caught.what());
    } catch (...) {
        std::snprintf(error, error_size, "unknown failure");
    }
    return nullptr;
}

void quiesce_fmu_free(const char *text) {
    delete[] text;
}
