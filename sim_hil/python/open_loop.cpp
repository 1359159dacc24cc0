#include "open_loop.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "input_error.h"

namespace quiesce {

namespace {

PlantModel with_longer_steps(PlantModel model, double factor) {
    model.max_step_s *= factor;
    return model;
}

} // namespace

OpenLoop::OpenLoop(const PlantModel &model, const Excitation &excitation, int tick_rate_Hz,
                   std::size_t ticks, double step_factor)
    : model_(with_longer_steps(model, step_factor)), equations_(model_), driver_(model_.driver),
      pullback_(model_), ticks_(ticks),
      steps_(static_cast<std::size_t>(steps_per_tick(model_, 1.0 / tick_rate_Hz))),
      step_rate_Hz_(static_cast<double>(tick_rate_Hz) * static_cast<double>(steps_)),
      step_s_(1.0 / step_rate_Hz_), rk4_(equations_.state_count()), k1_(equations_.state_count()),
      at_ticks_(ticks), reached_(pullback_.nothing_reached()), tape_(steps_),
      of_rates_(equations_.state_count()), of_stage_(equations_.state_count()) {
    if (equations_.is_sampled()) {
        throw InputError("the plant's damper model runs at a sample time of its own, so that its "
                         "motion has no slopes; choose a model without delays");
    }
    for (const PlantDamper &one : model_.dampers) {
        half_step_coils_.emplace_back(one.coil, 0.5 * step_s_);
        remanences_.emplace_back(one.coil.remanence * model_.driver.max_current_A);
    }
    base_m_s2_.resize(2 * steps_ * ticks_ + 1);
    for (std::size_t i = 0; i < base_m_s2_.size(); ++i) {
        base_m_s2_[i] = excitation.at(0.5 * static_cast<double>(i) / step_rate_Hz_).base_accel_m_s2;
    }
}

OpenLoop::Currents OpenLoop::after_half_step(const Currents &before, const double *driver_A) const {
    Currents after{};
    for (std::size_t k = 0; k < half_step_coils_.size(); ++k) {
        after.coil_A[k] = half_step_coils_[k].step(before.coil_A[k], driver_A[k]);
        after.effective_A[k] = remanences_[k].step(before.effective_A[k], after.coil_A[k]);
    }
    return after;
}

/// weights: slopes by `after`; returns those by `before` and adds those by the driver's output.
OpenLoop::Currents OpenLoop::before_half_step(const Currents &weights, const Currents &before,
                                              const Currents &after, const double *driver_A,
                                              double *of_driver) const {
    Currents out{};
    for (std::size_t k = 0; k < half_step_coils_.size(); ++k) {
        // Where the play is engaged, the effective current moves with the coil's.
        const bool stays = after.effective_A[k] == before.effective_A[k] &&
                           after.effective_A[k] != after.coil_A[k];
        out.effective_A[k] = stays ? weights.effective_A[k] : 0.0;
        const double of_coil = weights.coil_A[k] + (stays ? 0.0 : weights.effective_A[k]);
        const double left = half_step_coils_[k].left(before.coil_A[k], driver_A[k]);
        out.coil_A[k] = left * of_coil;
        of_driver[k] += (1.0 - left) * of_coil;
    }
    return out;
}

DamperValues OpenLoop::rates_now(std::size_t step, const State &state) {
    return equations_.rates(0.0, state.currents.effective_A, state.y, k1_, base_accel(step, 0));
}

void OpenLoop::advance(std::size_t step, const double *driver_A, State &state, StepTape *tape) {
    Currents stage[3] = {state.currents, {}, {}};
    stage[1] = after_half_step(stage[0], driver_A);
    stage[2] = after_half_step(stage[1], driver_A);
    if (tape != nullptr) {
        tape->y[0] = state.y;
        std::copy(stage, stage + 3, tape->currents);
    }
    int calls = 0;
    rk4_.step(state.y, k1_, step_s_,
              [&](int at, const std::vector<double> &y, std::vector<double> &out) {
                  ++calls;
                  if (tape != nullptr) {
                      tape->y[calls] = y;
                  }
                  equations_.rates(0.0, stage[at].effective_A, y, out, base_accel(step, at));
              });
    state.currents = stage[2];
}

void OpenLoop::record(std::size_t tick, const State &state, const MotionColumns<double> &out) {
    const DamperValues force_N = rates_now(tick * steps_, state);
    const double base_m_s2 = base_accel(tick * steps_, 0);
    const std::size_t places = model_.places.size();
    for (std::size_t i = 0; i < places; ++i) {
        const PlaceTruth truth = equations_.at(model_.places[i], state.y, k1_, base_m_s2);
        out.disp_m[tick * places + i] = truth.displacement_m;
        out.accel_m_s2[tick * places + i] = truth.accel_m_s2;
    }
    const std::size_t dampers = model_.dampers.size();
    for (std::size_t k = 0; k < dampers; ++k) {
        out.stroke_m[tick * dampers + k] = equations_.stroke_m(k, state.y);
        out.force_N[tick * dampers + k] = force_N[k];
        out.coil_A[tick * dampers + k] = state.currents.coil_A[k];
    }
}

void OpenLoop::check(std::size_t tick, const State &state) const {
    std::ostringstream message;
    message << "the simulation stopped at t = "
            << static_cast<double>(tick * steps_) / step_rate_Hz_ << " s: ";
    if (!std::all_of(state.y.begin(), state.y.end(), [](double x) { return std::isfinite(x); })) {
        message << "it diverged; choose a smaller integration.max_step_us in the plant file";
        throw InputError(message.str());
    }
    const std::size_t closed = equations_.closed_damper(state.y);
    if (closed < model_.dampers.size()) {
        message << "the " << label(model_.dampers[closed])
                << " closed to the end of its range; shake less or check its stroke";
        throw InputError(message.str());
    }
}

void OpenLoop::run(const double *command_A, bool is_rounded, const MotionColumns<double> &out) {
    const std::size_t dampers = model_.dampers.size();
    driver_A_.assign(command_A, command_A + ticks_ * dampers);
    if (is_rounded) {
        std::transform(driver_A_.begin(), driver_A_.end(), driver_A_.begin(),
                       [&](double one_A) { return driver_.output_A(one_A); });
    }
    State now{std::vector<double>(equations_.state_count(), 0.0), {}};
    reached_ = pullback_.nothing_reached();
    for (std::size_t tick = 0; tick < ticks_; ++tick) {
        check(tick, now);
        pullback_.reach(now.y, reached_);
        record(tick, now, out);
        at_ticks_[tick] = now;
        for (std::size_t i = 0; i < steps_ && tick + 1 < ticks_; ++i) {
            if (i > 0) {
                rates_now(tick * steps_ + i, now);
            }
            advance(tick * steps_ + i, &driver_A_[tick * dampers], now, nullptr);
        }
    }
}

/// Slopes of of_rates_ times the rates and of_force_ times the forces there; of_force_ is spent.
void OpenLoop::pull_rates(const std::vector<double> &y, const Currents &at, Currents &of_currents) {
    std::fill(of_stage_.begin(), of_stage_.end(), 0.0);
    pullback_.add({reached_, y, at.effective_A}, {of_rates_, of_force_},
                  {of_stage_, of_currents.effective_A});
    of_force_ = {};
}

/// One classical Runge-Kutta step backwards: y + h/6 (k1 + 2 k2 + 2 k3 + k4).
void OpenLoop::pull_step(const StepTape &tape, const double *driver_A, double *of_driver) {
    static constexpr double kPart[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    static constexpr double kReach[4] = {0.5, 0.5, 1.0, 0.0}; // of each rate in the next stage
    static constexpr int kAt[4] = {0, 1, 1, 2};
    const std::vector<double> of_end = of_state_;
    Currents of_stages[3] = {{}, {}, of_currents_};
    std::fill(of_stage_.begin(), of_stage_.end(), 0.0);
    for (int stage = 3; stage >= 0; --stage) {
        for (std::size_t i = 0; i < of_rates_.size(); ++i) {
            of_rates_[i] = step_s_ * (kPart[stage] * of_end[i] + kReach[stage] * of_stage_[i]);
        }
        pull_rates(tape.y[stage], tape.currents[kAt[stage]], of_stages[kAt[stage]]);
        for (std::size_t i = 0; i < of_state_.size(); ++i) {
            of_state_[i] += of_stage_[i];
        }
    }
    for (int half = 1; half >= 0; --half) {
        const Currents earlier = before_half_step(of_stages[half + 1], tape.currents[half],
                                                  tape.currents[half + 1], driver_A, of_driver);
        for (std::size_t k = 0; k < kMaxDampers; ++k) {
            of_stages[half].coil_A[k] += earlier.coil_A[k];
            of_stages[half].effective_A[k] += earlier.effective_A[k];
        }
    }
    of_currents_ = of_stages[0];
}

/// What is recorded at a tick, of its state.
void OpenLoop::pull_record(std::size_t tick, const MotionColumns<const double> &weights) {
    const std::size_t modes = static_cast<std::size_t>(model_.structure.mode_count());
    const std::size_t places = model_.places.size();
    const std::size_t dampers = model_.dampers.size();
    std::fill(of_rates_.begin(), of_rates_.end(), 0.0);
    for (std::size_t i = 0; i < places; ++i) {
        for (std::size_t m = 0; m < modes; ++m) {
            const double shape = model_.places[i].shape[static_cast<Eigen::Index>(m)];
            of_state_[m] += shape * weights.disp_m[tick * places + i];
            of_rates_[modes + m] += shape * weights.accel_m_s2[tick * places + i];
        }
    }
    for (std::size_t k = 0; k < dampers; ++k) {
        of_force_[k] = weights.force_N[tick * dampers + k];
        of_currents_.coil_A[k] += weights.coil_A[tick * dampers + k];
        for (std::size_t m = 0; m < modes; ++m) {
            const double shape = model_.dampers[k].stroke[static_cast<Eigen::Index>(m)];
            of_state_[m] += shape * weights.stroke_m[tick * dampers + k];
        }
    }
    pull_rates(at_ticks_[tick].y, at_ticks_[tick].currents, of_currents_);
    for (std::size_t i = 0; i < of_state_.size(); ++i) {
        of_state_[i] += of_stage_[i];
    }
}

/// From the tick's end to its begin, integrated once more.
void OpenLoop::retreat(std::size_t tick, double *of_driver) {
    const double *driver_A = &driver_A_[tick * model_.dampers.size()];
    State now = at_ticks_[tick];
    for (std::size_t i = 0; i < steps_; ++i) {
        rates_now(tick * steps_ + i, now);
        advance(tick * steps_ + i, driver_A, now, &tape_[i]);
    }
    for (std::size_t i = steps_; i-- > 0;) {
        pull_step(tape_[i], driver_A, of_driver);
    }
}

void OpenLoop::pull(const MotionColumns<const double> &weights, double *out) {
    const std::size_t dampers = model_.dampers.size();
    if (driver_A_.empty()) {
        throw InputError("there is no run to go back through");
    }
    std::fill(out, out + ticks_ * dampers, 0.0);
    of_state_.assign(equations_.state_count(), 0.0);
    of_currents_ = {};
    of_force_ = {};
    for (std::size_t tick = ticks_; tick-- > 0;) {
        if (tick + 1 < ticks_) {
            retreat(tick, out + tick * dampers);
        }
        pull_record(tick, weights);
    }
}

} // namespace quiesce
