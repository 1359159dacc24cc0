/// What a kernel is: the equations of one damper model, written once for a double, for sixteen
/// candidates at once, and for what is written in other languages from them
/// (python/equations/traced.h). A kernel is a struct with
///
///   static constexpr const char *kName, *kTitle, *kSource;
///   static constexpr std::array<ParameterInfo, N> kParameters;
///   static constexpr int kStates;           // 0: the force is a function of the motion
///   static constexpr bool kUsesAccel;       // looks at the acceleration (its sign)
///   template <class T> static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates);
///   template <class T> static T fastest_rate_1_s(const T *p, const T &speed_m_s);
///   static double stiffest_N_s_m(const double *p);
///   static double stiffest_N_m(const double *p);
///   static bool is_passive(const double *p);
///
/// force_N: resisting force (> 0 opposes v > 0) and the rates of the kStates states, which start at
/// zero. fastest_rate_1_s: bound of |d rate / d state| at this speed; the classical Runge-Kutta
/// step must stay below 2.78 / it. is_passive: these parameters cannot give out energy that was not
/// put in, at constant current and without the offset (sufficient, not necessary).
///
/// Add a model: one header in kernels/ (BoucWen: bouc_wen.h), its include and its line in
/// kernels.h.
#ifndef QUIESCE_KERNEL_H
#define QUIESCE_KERNEL_H

#include <array>
#include <cstddef>

namespace quiesce {

/// What a damper sees at one instant, in SI units: displacement (m) from mid-stroke, velocity
/// (m/s), acceleration (m/s2) of its ends, and the coil current (A) after all lags.
template <class T>
struct Motion {
    T x;
    T v;
    T a;
    T i;
};

/// Natural size of a parameter: F^force X^disp V^speed, where F, X and V are the largest force,
/// displacement and speed of the damper or of a recording. Search ranges are multiples of it.
struct Scale {
    int force;
    int disp;
    int speed;
};

struct ParameterInfo {
    const char *name; ///< with its unit, as in files: "c0_N_s_m"
    const char *unit; ///< for people: "N s/m"
    double min;       ///< admissible values; where a current law leaves them it is cut off there
    double max;
    double search_low; ///< where to look first, in multiples of scale
    double search_high;
    Scale scale;
    bool is_linear;       ///< the force is linear in it (with the other such parameters)
    bool follows_current; ///< may depend on the current
    const char *text;
};

constexpr double kUnbounded = 1e15;

/// Scales that most parameters have.
constexpr Scale kForceScale{1, 0, 0};      // N
constexpr Scale kDampingScale{1, 0, -1};   // N s/m
constexpr Scale kStiffnessScale{1, -1, 0}; // N/m
constexpr Scale kMassScale{1, 1, -2};      // kg
constexpr Scale kPerLengthScale{0, -1, 0}; // 1/m
constexpr Scale kPerSpeedScale{0, 0, -1};  // s/m
constexpr Scale kRateScale{0, -1, 1};      // 1/s
constexpr Scale kSpeedScale{0, 0, 1};      // m/s
constexpr Scale kLengthScale{0, 1, 0};     // m
constexpr Scale kNoScale{0, 0, 0};         // -

} // namespace quiesce

#endif
