#include "resources.h"

#include <set>

#include "toml_table.h"

namespace quiesce {

namespace {

using MakeModel = std::unique_ptr<FmuModel> (*)(const std::vector<std::string> &);

/// A kind of FMU is a line here and a file.
const std::vector<std::pair<std::string, MakeModel>> kKinds = {
    {"plant", make_plant_model},
    {"damper", make_damper_model},
    {"controller", make_controller_model},
};

/// Options whose value is a file.
const std::set<std::string> kFiles = {"--scenario", "--plant",  "--board",     "--damper",
                                      "--rules",    "--pulses", "--law-table", "--force-map"};

/// The byte of %41; throws InputError where it is none.
char decoded(const std::string &text, std::size_t at) {
    try {
        std::size_t length = 0;
        const int byte = std::stoi(text.substr(at, 2), &length, 16);
        if (length == 2) {
            return static_cast<char>(byte);
        }
    } catch (const std::exception &) {
        // said below
    }
    throw InputError("resource location '" + text + "': % stands before two hexadecimal digits");
}

std::string path_of(const std::string &folder) {
    if (folder.rfind("file:", 0) != 0) {
        return folder;
    }
    std::string path = folder.substr(5);
    if (path.rfind("//", 0) == 0) { // file://host/path, mostly without a host
        path.erase(0, std::min(path.find('/', 2), path.size()));
    }
    std::string out;
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (path[i] == '%') {
            out += decoded(path, i + 1);
            i += 2;
        } else {
            out += path[i];
        }
    }
    return out;
}

} // namespace

FmuResources read_resources(const std::string &folder) {
    const std::string path = path_of(folder);
    const TomlFile file(path + "/fmu.toml", "quiesce-fmu", 1);
    TomlTable root = file.root();
    root.text("schema");
    root.integer("version", 1, 1);
    FmuResources out;
    out.token = root.text("token");
    std::vector<std::string> kinds;
    for (const auto &[kind, make] : kKinds) {
        kinds.push_back(kind);
    }
    out.kind = root.choice("kind", kinds);
    out.arguments = root.texts("arguments");
    root.reject_unknown_keys();
    for (std::size_t i = 1; i < out.arguments.size(); ++i) {
        if (kFiles.count(out.arguments[i - 1]) != 0) {
            out.arguments[i] = path + "/" + out.arguments[i];
        }
    }
    return out;
}

std::unique_ptr<FmuModel> make_model(const FmuResources &resources) {
    for (const auto &[kind, make] : kKinds) {
        if (kind == resources.kind) {
            return make(resources.arguments);
        }
    }
    throw InputError("fmu.toml: kind: there is no '" + resources.kind + "'");
}

} // namespace quiesce
