/// A damper alone as an FMU, for a structure that is somebody else's: stroke and its velocity go
/// in, and the command; the resisting force comes out.
#include <algorithm>
#include <cmath>

#include "accel_estimate.h"
#include "arguments.h"
#include "damper_section.h"
#include "remanence.h"
#include "resources.h"
#include "rk4.h"

namespace quiesce {

namespace {

constexpr int kTickRate_Hz = 10000;
/// Longest step of the states, in their shortest time constants: well inside of what is stable.
constexpr double kLongestStep = 0.5;
constexpr double kMostSteps = 1000.0;

class DamperFmu final : public FmuModel {
  public:
    explicit DamperFmu(const DamperChoice &choice);

  private:
    void start() override;
    void tick() override;
    void evaluate() override;
    void visit_state(StateArchive &archive) override;
    DamperInput seen(double after_s) const;
    void integrate(double from_s, double step_s);

    std::shared_ptr<const Damper> damper_;
    CoilParams coil_params_;
    double remanence_A_;
    std::size_t stroke_, velocity_, command_, factor_;
    std::size_t force_, current_;
    std::optional<std::size_t> temperature_;
    Rk4 rk4_;
    std::vector<double> state_, rates_;
    double coil_A_ = 0.0;
    double effective_A_ = 0.0;
};

Variable real(const std::string &name, Causality causality, const std::string &unit,
              const std::string &what) {
    return {name, VariableType::real, causality, Variability::continuous, unit, what};
}

DamperFmu::DamperFmu(const DamperChoice &choice)
    : FmuModel(kTickRate_Hz), damper_(choice.damper),
      coil_params_(choice.coil.value_or(CoilParams{0.0, 0.0})),
      remanence_A_(coil_params_.remanence * choice.max_current_A.value_or(0.0)),
      stroke_(declare(real("stroke_m", Causality::input, "m", "from rest; > 0: it is longer"))),
      velocity_(declare(real("velocity_m_s", Causality::input, "m/s", "of the stroke"))),
      command_(declare(choice.is_in_volts
                           ? real("command_V", Causality::input, "V", "for its driver")
                           : real("current_cmd_A", Causality::input, "A", "for its driver"))),
      factor_(
          declare({"force_factor", VariableType::real, Causality::parameter, Variability::tunable,
                   "", "by which this one is stronger", 1.0, 0.0, 100.0})),
      force_(declare(real("force_N", Causality::output, "N", "> 0 resists a stroke that grows"))),
      current_(declare(choice.is_in_volts
                           ? real("coil_V", Causality::output, "V", "after the coil's lag")
                           : real("current_A", Causality::output, "A", "in its coil"))),
      rk4_(damper_->state_count()), state_(damper_->state_count(), 0.0),
      rates_(damper_->state_count(), 0.0) {
    if (damper_->fluid_C(state_.data())) {
        temperature_ = declare(real("temperature_degC", Causality::output, "degC", "of its fluid"));
    }
}

void DamperFmu::start() {
    std::fill(state_.begin(), state_.end(), 0.0);
    coil_A_ = 0.0;
    effective_A_ = 0.0;
    evaluate();
}

/// Inputs are those of the step's start: the stroke goes on at its velocity.
DamperInput DamperFmu::seen(double after_s) const {
    DamperInput in{};
    in.velocity_m_s = value(velocity_);
    in.position_m = value(stroke_) + after_s * in.velocity_m_s;
    in.current_A = effective_A_;
    return in;
}

void DamperFmu::integrate(double from_s, double step_s) {
    damper_->force_N(seen(from_s), state_.data(), rates_.data());
    rk4_.step(state_, rates_, step_s,
              [&](int at, const std::vector<double> &y, std::vector<double> &out) {
                  damper_->force_N(seen(from_s + 0.5 * at * step_s), y.data(), out.data());
              });
}

void DamperFmu::tick() {
    const double driver_A = std::max(0.0, value(command_));
    coil_A_ = Coil(coil_params_, tick_s()).step(coil_A_, driver_A);
    effective_A_ = Remanence(remanence_A_).step(effective_A_, coil_A_);
    const double steps =
        std::clamp(std::ceil(damper_->fastest_rate_1_s(effective_A_) * tick_s() / kLongestStep),
                   1.0, kMostSteps);
    const double step_s = tick_s() / steps;
    for (int i = 0; !state_.empty() && i < static_cast<int>(steps); ++i) {
        integrate(i * step_s, step_s);
        damper_->after_step(seen((i + 1) * step_s), state_.data(), step_s);
    }
    put(stroke_, value(stroke_) + tick_s() * value(velocity_)); // until the importer says more
    if (value(stroke_) <= damper_->lowest_position_m()) {
        throw InputError("the damper closed to the end of its range");
    }
}

void DamperFmu::evaluate() {
    const double force_N = damper_->force_N(seen(0.0), state_.data(), rates_.data());
    if (!std::isfinite(force_N)) {
        throw InputError("the damper's force is no number: are stroke and velocity in m and m/s?");
    }
    put(force_, value(factor_) * force_N);
    put(current_, coil_A_);
    if (temperature_) {
        put(*temperature_, damper_->fluid_C(state_.data()).value_or(0.0));
    }
}

void DamperFmu::visit_state(StateArchive &archive) {
    archive(state_);
    archive(coil_A_);
    archive(effective_A_);
}

} // namespace

std::unique_ptr<FmuModel> make_damper_model(const std::vector<std::string> &words) {
    const Arguments arguments("damper", words, {"damper"});
    arguments.require_no_positional();
    const std::string file = arguments.required("damper");
    DamperChoice choice = load_damper(file);
    if (!choice.is_usable) {
        throw InputError(file + ": published, but of no use as it is; its file says why");
    }
    if (choice.damper->uses_accel()) {
        choice.damper = std::make_shared<AccelEstimate>(choice.damper);
    }
    return std::make_unique<DamperFmu>(choice);
}

} // namespace quiesce
