/// What an FMU carries beside its library, in its folder of resources: fmu.toml with its kind and
/// the bench's arguments that made it, and the files that they name.
#ifndef QUIESCE_FMU_RESOURCES_H
#define QUIESCE_FMU_RESOURCES_H

#include <memory>
#include <string>
#include <vector>

#include "model.h"

namespace quiesce {

struct FmuResources {
    std::string token;                  ///< that names the model: XML and library belong together
    std::string kind;                   ///< plant, damper or controller
    std::vector<std::string> arguments; ///< files as paths that can be opened
};

/// folder: a path, or a URI that begins with file:. Throws InputError.
FmuResources read_resources(const std::string &folder);

/// Throws InputError where the bench would refuse the arguments.
std::unique_ptr<FmuModel> make_model(const FmuResources &resources);

std::unique_ptr<FmuModel> make_plant_model(const std::vector<std::string> &words);
std::unique_ptr<FmuModel> make_damper_model(const std::vector<std::string> &words);
std::unique_ptr<FmuModel> make_controller_model(const std::vector<std::string> &words);

} // namespace quiesce

#endif
