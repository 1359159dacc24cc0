#include "senses.h"

#include <algorithm>
#include <cmath>

#include "input_error.h"

namespace quiesce {

namespace {

/// Keeps the noise of one sensor from being another's in a run with the next seed.
constexpr std::uint64_t kNextNoise = 0x9E3779B97F4A7C15u;

/// One count in the unit of what is measured: the board has thousandths of it.
double unit_per_count(const quiesce_board_sensor_t &spec) {
    return 1e-3 * spec.scale * spec.polarity;
}

} // namespace

BoardSensor::BoardSensor(const Rig &rig, std::size_t index, std::int32_t tick_rate_Hz,
                         std::uint64_t seed)
    : spec_(rig.board().sensor[index]),
      source_((quiesce_sense_is_of_body(spec_.sense)
                   ? rig.place_of
                   : rig.damper_of)[static_cast<std::size_t>(spec_.at)]),
      noise_counts_(rig.noise[index] / std::abs(unit_per_count(spec_))),
      tick_rate_Hz_(tick_rate_Hz), other_(rig.sensors[index].other),
      latency_(ticks_in(spec_.latency_us, tick_rate_Hz)), noise_(seed) {
    if (rig.sensors[index].params) {
        dynamics_.emplace(*rig.sensors[index].params, tick_rate_Hz, seed);
    }
}

/// In the unit of the board: um/s2, um/s, nm, mN, mdegC.
double BoardSensor::measure(const Plant &plant, std::size_t source) const {
    switch (spec_.sense) {
    case QUIESCE_SENSE_ACCEL:
        return 1e6 * plant.place(source).accel_m_s2;
    case QUIESCE_SENSE_VELOCITY:
        return 1e6 * plant.place(source).velocity_m_s;
    case QUIESCE_SENSE_DISPLACEMENT:
        return 1e9 * plant.place(source).displacement_m;
    case QUIESCE_SENSE_STROKE:
        return 1e9 * plant.damper(source).stroke_m;
    case QUIESCE_SENSE_STROKE_VELOCITY:
        return 1e6 * plant.damper(source).velocity_m_s;
    case QUIESCE_SENSE_FORCE:
        return 1e3 * plant.damper(source).force_N;
    case QUIESCE_SENSE_TEMPERATURE:
        return 1e3 * plant.damper(source).fluid_C.value(); // make_rig has seen that it has one
    default:                                               // make_rig lets no other through
        throw InputError("a sensor measures what the plant does not have");
    }
}

/// After what the sensor does to it.
double BoardSensor::shown(const Plant &plant) {
    const double value = measure(plant, source_) + gravity_;
    if (!dynamics_) {
        return value;
    }
    const std::size_t coil = quiesce_sense_is_of_body(spec_.sense) ? 0 : source_;
    return dynamics_->step(value, measure(plant, other_), plant.damper(coil).coil_A);
}

/// In the first tick that begins in each of its periods.
bool BoardSensor::is_due(std::int64_t tick) const {
    if (spec_.period_us == 0 || tick == 0) {
        return true;
    }
    const auto period = [this](std::int64_t at) {
        return at * 1000000 / (tick_rate_Hz_ * spec_.period_us);
    };
    return period(tick) != period(tick - 1);
}

bool BoardSensor::sample(const Plant &plant, std::int64_t tick, std::int32_t &counts) {
    const double value = latency_.pass(shown(plant));
    if (!is_due(tick)) {
        return false;
    }
    const double limit = spec_.full_scale_counts;
    const double exact = value / unit_per_count(spec_) + noise_counts_ * noise_.gaussian() +
                         static_cast<double>(spec_.offset_counts);
    counts = static_cast<std::int32_t>(std::floor(std::clamp(exact, -limit, limit) + 0.5));
    return true;
}

void BoardSensor::lie(double gravity_m_s2) {
    gravity_ = spec_.sense == QUIESCE_SENSE_ACCEL ? 1e6 * gravity_m_s2 : 0.0;
}

void BoardSensor::visit_state(StateArchive &archive) {
    if (dynamics_) {
        dynamics_->visit_state(archive);
    }
    latency_.visit_state(archive);
    noise_.visit_state(archive);
}

Senses::Senses(const PlantModel &plant, const Rig *rig, std::int32_t tick_rate_Hz,
               std::uint64_t seed)
    : own_(plant.sensor, seed) {
    if (plant.transducer) {
        transducer_.emplace(plant.transducer->params, tick_rate_Hz, seed);
    }
    for (std::size_t i = 0; plant.transducer && i < plant.places.size(); ++i) {
        if (plant.places[i].name == plant.transducer->cross_talk_from) {
            other_ = i;
        }
    }
    for (std::size_t i = 0; rig != nullptr && i < rig->file.sensors.size(); ++i) {
        sensors_.emplace_back(*rig, i, tick_rate_Hz, seed ^ i * kNextNoise);
    }
}

double Senses::own_accel_m_s2(const Plant &plant) {
    const double accel_m_s2 = plant.truth().accel_m_s2 + gravity_m_s2_;
    if (!transducer_) {
        return accel_m_s2;
    }
    const double other_um_s2 = other_ ? 1e6 * plant.place(*other_).accel_m_s2 : 0.0;
    return 1e-6 * transducer_->step(1e6 * accel_m_s2, other_um_s2, plant.damper(0).coil_A);
}

void Senses::lie(double gravity_m_s2) {
    gravity_m_s2_ = gravity_m_s2;
    for (BoardSensor &sensor : sensors_) {
        sensor.lie(gravity_m_s2);
    }
}

void Senses::read(const Plant &plant, std::int64_t tick, lockstep_stimulus_t &out) {
    if (sensors_.empty()) {
        out.counts[0] = own_.sample_counts(own_accel_m_s2(plant));
        out.flags |= LOCKSTEP_FRESH;
        return;
    }
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        if (sensors_[i].sample(plant, tick, out.counts[i])) {
            out.flags |= LOCKSTEP_FRESH << i;
        }
    }
}

std::vector<std::int32_t> Senses::full_scales() const {
    if (sensors_.empty()) {
        return {own_.full_scale_counts()};
    }
    std::vector<std::int32_t> out;
    for (const BoardSensor &sensor : sensors_) {
        out.push_back(sensor.full_scale_counts());
    }
    return out;
}

void Senses::visit_state(StateArchive &archive) {
    own_.visit_state(archive);
    if (transducer_) {
        transducer_->visit_state(archive);
    }
    for (BoardSensor &sensor : sensors_) {
        sensor.visit_state(archive);
    }
}

} // namespace quiesce
