/// scenario-check: validates a scenario file together with the plant that it names.
#include <cstdio>

#include "arguments.h"
#include "commands.h"
#include "plant_file.h"
#include "run_options.h"
#include "scenario.h"

namespace quiesce {

int cmd_scenario_check(const std::vector<std::string> &words) {
    const Arguments arguments("scenario-check", words, {});
    const std::string file = arguments.only_positional("FILE");
    const Scenario scenario = load_scenario(file);
    const PlantModel plant = load_plant(plant_of(scenario));
    require_base(scenario, plant);
    std::printf("%s: scenario %s is valid\n", file.c_str(), scenario.name.c_str());
    std::printf("  plant %s, %g s, seed %llu\n", plant.name.c_str(), scenario.duration_s,
                static_cast<unsigned long long>(scenario.seed));
    for (const SegmentSpec &segment : scenario.segments) {
        std::printf("  %s\n", segment.summary.c_str());
    }
    std::printf("  %zu injected faults, %zu measurement windows%s\n", scenario.faults.size(),
                scenario.windows.size(), scenario.transient ? ", one transient" : "");
    return 0;
}

} // namespace quiesce
