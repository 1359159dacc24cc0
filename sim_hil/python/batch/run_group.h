/// A kernel over a motion: classical Runge-Kutta with the force of a step's beginning, which is its
/// first stage. One template for a double (one candidate) and a Wide (several).
#ifndef QUIESCE_RUN_GROUP_H
#define QUIESCE_RUN_GROUP_H

#include "elementary.h"
#include "field_law.h"
#include "group.h"
#include "kernel.h"

namespace quiesce {

/// How a T is read from and written to lanes that stand side by side.
template <class T>
struct LaneAccess;

template <class Kernel, class T>
class GroupRun {
  public:
    explicit GroupRun(const GroupJob &job) : job_(job), step_s_(job.motion->step_s()) {
        for (std::size_t k = 0; k < kCount * kMaxCoefficients; ++k) {
            coefficients_[k] = load(job.coefficients, k);
        }
        for (std::size_t k = 0; k < kRigCount; ++k) {
            rig_[k] = load(job.rig, k);
        }
        field_ = {rig_[kRigFieldExponent], rig_[kRigFieldSaturation], rig_[kRigFieldReference]};
        const T half = T(-0.5 * step_s_);
        rise_left_ = lag_left(half, rig_[kRigRise]);
        fall_left_ = lag_left(half, rig_[kRigFall]);
    }

    /// Flattened: calls inside the loop would pass lanes through memory.
    __attribute__((flatten)) void operator()() {
        T p[kCount];
        T z[kSlots];
        for (T &one : z) {
            one = T(0.0);
        }
        T current = T(job_.motion->at(0)[3]);
        parameters(current, p);
        const std::size_t steps = job_.motion->steps();
        const auto substeps = static_cast<std::size_t>(job_.motion->substeps());
        std::size_t until_sample = 0;
        std::size_t sample = 0;
        for (std::size_t step = 0; step < steps; ++step) {
            T k1[kSlots];
            const Motion<T> now = motion(2 * step, current);
            const T force = Kernel::force_N(p, now, z, k1);
            if (until_sample == 0) {
                store(force, now, sample++);
                until_sample = substeps;
            }
            --until_sample;
            advance(step, p, z, k1, current);
        }
        T rates[kSlots];
        const Motion<T> now = motion(2 * steps, current);
        store(Kernel::force_N(p, now, z, rates), now, sample);
    }

  private:
    static constexpr std::size_t kCount = Kernel::kParameters.size();
    static constexpr std::size_t kSlots = Kernel::kStates > 0 ? Kernel::kStates : 1;

    static T load(const double *values, std::size_t index) {
        return LaneAccess<T>::load(values, index);
    }

    /// Part of a difference that a lag leaves after half a step; 0 without lag.
    static T lag_left(const T &half, const T &time_constant) {
        const T safe = larger(time_constant, T(1e-12));
        return select(time_constant > T(1e-9), exponential(half / safe), T(0.0));
    }

    /// The motion as the force channel shows it: earlier by the skew (first order).
    Motion<T> motion(std::size_t index, const T &current) const {
        const double *at = job_.motion->at(index);
        const T v = T(at[1]);
        const T a = T(at[2]);
        return {T(at[0]) - rig_[kRigSkew] * v, v - rig_[kRigSkew] * a, a, current};
    }

    void parameters(const T &coil_current, T *p) const {
        const T current = job_.has_field_law ? field_.effective(coil_current) : coil_current;
        for (std::size_t k = 0; k < kCount; ++k) {
            const T *c = coefficients_ + k * kMaxCoefficients;
            const ParameterInfo &info = Kernel::kParameters[k];
            const T value = job_.has_current_law ? c[0] + current * (c[1] + current * c[2]) : c[0];
            p[k] = clipped(value, T(info.min), T(info.max));
        }
    }

    /// The coil's current half a step after `index`.
    T lagged(std::size_t index, const T &current) const {
        const T target = T(0.5 * (job_.motion->at(index)[3] + job_.motion->at(index + 1)[3]));
        const T exact = T(job_.motion->at(index + 1)[3]);
        const T left = select(target > current, rise_left_, fall_left_);
        return select(left > T(0.0), target + (current - target) * left, exact);
    }

    void advance(std::size_t step, T *p, T *z, const T *k1, T &current) {
        const T middle = lagged(2 * step, current);
        const T end = lagged(2 * step + 1, middle);
        if constexpr (Kernel::kStates > 0) {
            const T h = T(step_s_);
            const T half = T(0.5 * step_s_);
            T moved[kSlots];
            T k2[kSlots];
            T k3[kSlots];
            T k4[kSlots];
            const Motion<T> at_middle = motion(2 * step + 1, middle);
            law(middle, p);
            shifted(z, half, k1, moved);
            Kernel::force_N(p, at_middle, moved, k2);
            shifted(z, half, k2, moved);
            Kernel::force_N(p, at_middle, moved, k3);
            shifted(z, h, k3, moved);
            law(end, p);
            Kernel::force_N(p, motion(2 * step + 2, end), moved, k4);
            const T sixth = T(step_s_ / 6.0);
            for (std::size_t k = 0; k < kSlots; ++k) {
                z[k] = z[k] + sixth * (k1[k] + T(2.0) * (k2[k] + k3[k]) + k4[k]);
            }
        } else {
            law(end, p);
        }
        current = end;
    }

    void law(const T &current, T *p) const {
        if (job_.has_current_law) {
            parameters(current, p);
        }
    }

    static void shifted(const T *z, const T &step, const T *rates, T *out) {
        for (std::size_t k = 0; k < kSlots; ++k) {
            out[k] = z[k] + step * rates[k];
        }
    }

    void store(const T &force, const Motion<T> &now, std::size_t sample) {
        const double time_s =
            static_cast<double>(sample) * step_s_ * static_cast<double>(job_.motion->substeps());
        const T total =
            force + rig_[kRigInertia] * now.a + rig_[kRigOffset] + rig_[kRigDrift] * T(time_s);
        LaneAccess<T>::store(job_.force_N, sample, total);
    }

    const GroupJob &job_;
    double step_s_;
    T coefficients_[kCount * kMaxCoefficients];
    T rig_[kRigCount];
    FieldLaw<T> field_;
    T rise_left_;
    T fall_left_;
};

} // namespace quiesce

#endif
