#include "plant_step.h"

#include <limits>
#include <memory>

#include "input_error.h"
#include "plant.h"
#include "plant_handle.h"
#include "pushed_segment.h"

namespace quiesce {

namespace {

/// With the sensor as a place, so that its velocity is there, too.
PlantModel with_sensor_place(PlantModel model) {
    const Structure &structure = model.structure;
    model.places = {{"sensor", structure.at_sensor, structure.base_at_sensor}};
    return model;
}

Excitation excitation_of(const std::shared_ptr<const Stretch> &stretch, int tick_rate_Hz) {
    if (tick_rate_Hz < 1 || tick_rate_Hz > 1000000) {
        throw InputError("a run: expected 1 to 1000000 ticks a second");
    }
    return pushed_by(stretch, tick_rate_Hz);
}

} // namespace

} // namespace quiesce

struct quiesce_run {
    quiesce_run(const quiesce::PlantModel &model, int tick_rate_Hz)
        : excitation(quiesce::excitation_of(stretch, tick_rate_Hz)),
          plant(quiesce::with_sensor_place(model), excitation, tick_rate_Hz) {}

    void advance(const quiesce::Push &push, double command_A) {
        stretch->start_tick = static_cast<double>(plant.tick());
        stretch->from = stretch->to;
        stretch->to = push;
        plant.command(0, command_A, quiesce::ActuatorFault::none);
        plant.advance();
    }

    quiesce_now now() const {
        const quiesce::PlaceTruth sensor = plant.place(0);
        const quiesce::DamperTruth damper = plant.damper(0);
        return {sensor.displacement_m,
                sensor.velocity_m_s,
                sensor.accel_m_s2,
                damper.stroke_m,
                damper.velocity_m_s,
                damper.force_N,
                damper.coil_A,
                damper.fluid_C.value_or(std::numeric_limits<double>::quiet_NaN())};
    }

    std::shared_ptr<quiesce::Stretch> stretch = std::make_shared<quiesce::Stretch>();
    quiesce::Excitation excitation;
    quiesce::Plant plant;
};

quiesce_run *quiesce_run_start(const quiesce_plant *plant, int tick_rate_Hz, quiesce_now *now,
                               char *error, std::size_t error_size) {
    quiesce_run *run = nullptr;
    quiesce::guarded(
        [&] {
            auto made = std::make_unique<quiesce_run>(plant->model, tick_rate_Hz);
            *now = made->now();
            run = made.release();
        },
        error, error_size);
    return run;
}

void quiesce_run_free(quiesce_run *run) {
    delete run;
}

int quiesce_run_advance(quiesce_run *run, const quiesce_acting *acting, quiesce_now *now,
                        char *error, std::size_t error_size) {
    return quiesce::guarded(
        [&] {
            run->advance({acting->force_N, acting->base_accel_m_s2}, acting->command_A);
            *now = run->now();
        },
        error, error_size);
}
