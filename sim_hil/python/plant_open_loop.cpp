#include "plant_open_loop.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "input_error.h"
#include "open_loop.h"
#include "plant_file.h"
#include "plant_handle.h"
#include "record_segment.h"

namespace quiesce {

namespace {

Excitation excitation_of(const quiesce_shaking &shaking) {
    std::vector<RecordPoint> points;
    for (std::size_t i = 0; i < shaking.points; ++i) {
        points.push_back({shaking.time_s[i], shaking.accel_m_s2[i]});
    }
    Excitation out;
    out.append(std::make_unique<RecordSegment>(std::move(points), shaking.gain, shaking.time_scale),
               static_cast<double>(shaking.ticks) / shaking.tick_rate_Hz);
    return out;
}

OpenLoop open_loop(const std::string &plant_file, const quiesce_shaking &shaking) {
    if (shaking.tick_rate_Hz < 1 || shaking.tick_rate_Hz > 1000000 || shaking.ticks < 2 ||
        shaking.points < 2 || !(shaking.time_scale > 0.0) || !(shaking.step_factor >= 1.0)) {
        throw InputError("open loop: expected 1 to 1000000 ticks a second, 2 ticks and points or "
                         "more, a time scale above 0 and a step factor of 1 or more");
    }
    return {load_plant(plant_file), excitation_of(shaking), shaking.tick_rate_Hz, shaking.ticks,
            shaking.step_factor};
}

} // namespace

} // namespace quiesce

struct quiesce_open_loop {
    quiesce::OpenLoop loop;
};

quiesce_open_loop *quiesce_open_loop_start(const char *plant_file, const quiesce_shaking *shaking,
                                           char *error, std::size_t error_size) {
    std::unique_ptr<quiesce_open_loop> out;
    const auto work = [&] {
        out = std::make_unique<quiesce_open_loop>(
            quiesce_open_loop{quiesce::open_loop(plant_file, *shaking)});
    };
    quiesce::guarded(work, error, error_size);
    return out.release();
}

void quiesce_open_loop_free(quiesce_open_loop *loop) {
    delete loop;
}

double quiesce_open_loop_max_current_A(const quiesce_open_loop *loop) {
    return loop->loop.model().driver.max_current_A;
}

const char *quiesce_open_loop_place(const quiesce_open_loop *loop, std::size_t index) {
    const std::vector<quiesce::Place> &places = loop->loop.model().places;
    return index < places.size() ? places[index].name.c_str() : nullptr;
}

const char *quiesce_open_loop_damper(const quiesce_open_loop *loop, std::size_t index) {
    const std::vector<quiesce::PlantDamper> &dampers = loop->loop.model().dampers;
    return index < dampers.size() ? dampers[index].name.c_str() : nullptr;
}

int quiesce_open_loop_run(quiesce_open_loop *loop, const double *command_A, int is_rounded,
                          const quiesce_motion *motion, char *error, std::size_t error_size) {
    const auto work = [&] {
        const quiesce::OpenLoop &it = loop->loop;
        const double *end = command_A + it.ticks() * it.model().dampers.size();
        const double most_A = it.model().driver.max_current_A * (1.0 + 1e-9);
        if (!std::all_of(command_A, end, [&](double x) { return x >= 0.0 && x <= most_A; })) {
            throw quiesce::InputError("open loop: a current is not within 0 and the driver's most");
        }
        loop->loop.run(command_A, is_rounded != 0,
                       {motion->disp_m, motion->accel_m_s2, motion->stroke_m, motion->force_N,
                        motion->coil_A});
    };
    return quiesce::guarded(work, error, error_size);
}

int quiesce_open_loop_pull(quiesce_open_loop *loop, const quiesce_motion *weights, double *out,
                           char *error, std::size_t error_size) {
    const auto work = [&] {
        loop->loop.pull({weights->disp_m, weights->accel_m_s2, weights->stroke_m, weights->force_N,
                         weights->coil_A},
                        out);
    };
    return quiesce::guarded(work, error, error_size);
}
