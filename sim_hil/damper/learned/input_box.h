/// What a learned model sees: its inputs in a fixed order, held within the range it was trained in.
/// Outside of it such a model is worth nothing, so inputs are cut off there.
#ifndef QUIESCE_INPUT_BOX_H
#define QUIESCE_INPUT_BOX_H

#include <array>
#include <cstddef>
#include <vector>

#include "damper.h"

namespace quiesce {

/// In the order in which models have them.
enum class InputKind { current, displacement, velocity, temperature };

constexpr std::size_t kMostInputs = 4;
using Inputs = std::array<double, kMostInputs>;

/// A, m, m/s or degrees C; min < max.
struct InputRange {
    InputKind kind;
    double min;
    double max;
};

class InputBox {
  public:
    /// 1 .. kMostInputs ranges, their kinds rising.
    explicit InputBox(std::vector<InputRange> ranges) : ranges_(std::move(ranges)) {}

    std::size_t count() const { return ranges_.size(); }
    const InputRange &range(std::size_t k) const { return ranges_[k]; }

    /// The inputs of this model, not cut off.
    Inputs picked(const DamperInput &input) const;
    /// Cut off at their ranges; in SI units, or from -1 at min to 1 at max.
    Inputs clamped(const DamperInput &input) const;
    Inputs scaled(const DamperInput &input) const;

    /// Middle and ends of a kind's range, or `fallback` three times where the model lacks it.
    std::array<double, 3> spread(InputKind kind, double fallback) const;

  private:
    std::vector<InputRange> ranges_;
};

/// Largest |d force / d velocity| (N s/m) or |d force / d position| (N/m) of a model without
/// memory, by differences over its box, at this current.
double steepest(const Damper &damper, const InputBox &box, InputKind along, double current_A);

/// A model without memory.
class StaticDamper : public Damper {
  public:
    /// stroke_m > 0: the model ends at -stroke_m.
    StaticDamper(InputBox box, double stroke_m) : box_(std::move(box)), stroke_m_(stroke_m) {}

    double stiffest_N_s_m(double current_A) const override {
        return steepest(*this, box_, InputKind::velocity, current_A);
    }
    double stiffest_N_m(double current_A) const override {
        return steepest(*this, box_, InputKind::displacement, current_A);
    }
    double lowest_position_m() const override { return -stroke_m_; }

  protected:
    const InputBox &box() const { return box_; }

  private:
    InputBox box_;
    double stroke_m_;
};

} // namespace quiesce

#endif
