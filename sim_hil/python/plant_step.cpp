#include "plant_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "input_error.h"
#include "plant.h"
#include "plant_handle.h"

namespace quiesce {

namespace {

struct Push {
    double force_N = 0.0;
    double base_accel_m_s2 = 0.0;
};

/// What acts in the tick that is integrated next.
struct Stretch {
    double start_tick = 0.0;
    Push from;
    Push to;
};

class StretchSegment final : public Segment {
  public:
    StretchSegment(std::shared_ptr<const Stretch> now, int tick_rate_Hz)
        : now_(std::move(now)), tick_rate_Hz_(tick_rate_Hz) {}

    ExcitationSample sample(double time_s, double start_cycles) const override {
        const double part = std::clamp(time_s * tick_rate_Hz_ - now_->start_tick, 0.0, 1.0);
        const auto between = [part](double from, double to) { return from + part * (to - from); };
        return {between(now_->from.force_N, now_->to.force_N), 0.0, start_cycles,
                between(now_->from.base_accel_m_s2, now_->to.base_accel_m_s2)};
    }

  private:
    std::shared_ptr<const Stretch> now_;
    double tick_rate_Hz_;
};

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
    Excitation excitation;
    excitation.append(std::make_unique<StretchSegment>(stretch, tick_rate_Hz), 1.0);
    return excitation;
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
