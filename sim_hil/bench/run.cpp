#include "run.h"

#include <chrono>
#include <cmath>

#include "loop.h"
#include "start.h"

namespace quiesce {

std::int64_t RunSetup::tick_count() const {
    return std::llround(scenario.duration_s * static_cast<double>(params.tick_rate_Hz));
}

RunTiming run_scenario(const RunSetup &setup, ControllerLink &link,
                       const std::vector<TickObserver *> &observers) {
    start_controller(link, setup.board(), setup.params, setup.tables);
    Loop loop(setup, link);
    const std::int64_t ticks = setup.tick_count();
    const auto start = std::chrono::steady_clock::now();
    while (loop.next_tick() < ticks) {
        loop.tick(observers);
    }
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    return {ticks, wall.count(), static_cast<double>(ticks) * setup.tick_s() / wall.count()};
}

} // namespace quiesce
