/// Viscoplastic network: what an MR damper on a rig does, as a sum of passive elements (ours).
///
///   F  = c v + k x + f0 + sum over elements of fy_e u_e
///   u' = v / travel - u / creep - yield(u) / slip
///   yield(u) = sign(u) (sqrt((|u| - ratio)^2 + (knee ratio)^2) + |u| - ratio sqrt(1 + knee^2)) / 2
///
/// Each element is a spring (oil column, seals, mountings) in series with a viscoplastic dashpot:
/// fy u is its force, fy / travel the spring's stiffness, ratio fy its yield force, creep and slip
/// the relaxation times below and beyond yield (viscosity over stiffness), knee the width of
/// yielding. A short slip is a Jenkins element, a short travel a Bingham element, ratio 0 a Maxwell
/// element. The current acts on ratio, travel and slip: at the current where ratio is 1, fy is the
/// yield force. A current that rises moves the threshold, not the force, so that nothing but
/// springs and dissipation is in it: with fy, c, k >= 0 it is passive, at a changing current too
/// where travel does not follow it.
///
/// Elements are told apart by the ranges in which their travel is searched, from stiff to soft.
#ifndef QUIESCE_VISCOPLASTIC_NETWORK_H
#define QUIESCE_VISCOPLASTIC_NETWORK_H

#include <algorithm>
#include <array>
#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

constexpr std::size_t kMostElements = 4;

struct NetworkElementNames {
    const char *yield, *ratio, *travel, *creep, *slip, *knee;
};

constexpr NetworkElementNames kElementNames[kMostElements] = {
    {"fy1_N", "ratio1", "travel1_m", "creep1_s", "slip1_s", "knee1"},
    {"fy2_N", "ratio2", "travel2_m", "creep2_s", "slip2_s", "knee2"},
    {"fy3_N", "ratio3", "travel3_m", "creep3_s", "slip3_s", "knee3"},
    {"fy4_N", "ratio4", "travel4_m", "creep4_s", "slip4_s", "knee4"},
};

/// Where the travel of each element is searched, in strokes: [elements - 1][element].
constexpr double kTravelLow[kMostElements][kMostElements] = {
    {0.003, 0, 0, 0}, {0.002, 0.03, 0, 0}, {0.002, 0.02, 0.1, 0}, {0.002, 0.01, 0.05, 0.2}};
constexpr double kTravelHigh[kMostElements][kMostElements] = {
    {3.0, 0, 0, 0}, {0.3, 10.0, 0, 0}, {0.1, 1.0, 20.0, 0}, {0.05, 0.3, 2.0, 20.0}};

constexpr Scale kPeriodScale{0, 1, -1}; // s: 1 / angular frequency

constexpr std::size_t kNetworkShared = 3;
constexpr std::size_t kNetworkPerElement = 6;

template <std::size_t Elements>
constexpr std::array<ParameterInfo, kNetworkShared + Elements * kNetworkPerElement>
network_parameters() {
    std::array<ParameterInfo, kNetworkShared + Elements * kNetworkPerElement> out{};
    out[0] = {"c_N_s_m", "N s/m",       0.0,  kUnbounded, 0.0,
              2.0,       kDampingScale, true, true,       "viscous damping in parallel"};
    out[1] = {"k_N_m", "N/m",           -kUnbounded, kUnbounded, -0.5,
              1.0,     kStiffnessScale, true,        false,      "stiffness in parallel"};
    out[2] = {"f0_N", "N",         -kUnbounded, kUnbounded, -0.5,
              0.5,    kForceScale, true,        false,      "offset (gas, preload)"};
    for (std::size_t e = 0; e < Elements; ++e) {
        const NetworkElementNames &names = kElementNames[e];
        ParameterInfo *own = out.data() + kNetworkShared + e * kNetworkPerElement;
        own[0] = {names.yield, "N",
                  0.0,         kUnbounded,
                  0.0,         1.0,
                  kForceScale, true,
                  false,       "yield force of the element where its ratio is 1"};
        own[1] = {names.ratio, "-",      0.0,   10.0, 1.0,
                  1.0,         kNoScale, false, true, "yield force over fy"};
        own[2] = {names.travel,
                  "m",
                  1e-9,
                  1e3,
                  kTravelLow[Elements - 1][e],
                  kTravelHigh[Elements - 1][e],
                  kLengthScale,
                  false,
                  true,
                  "displacement that takes its spring to fy"};
        own[3] = {names.creep, "s",          1e-4,  1e6,   0.1,
                  1000.0,      kPeriodScale, false, false, "relaxation time below yield"};
        own[4] = {names.slip, "s",          2e-4,  1e3,  0.005,
                  3.0,        kPeriodScale, false, true, "relaxation time beyond yield"};
        own[5] = {names.knee, "-",      0.0,   10.0,  0.02,
                  1.0,        kNoScale, false, false, "width of yielding, in yield forces"};
    }
    return out;
}

template <std::size_t Elements>
struct ViscoplasticNetwork {
    static constexpr const char *kSource = "Quiesce (docs/reference/damper-models.md)";
    static constexpr auto kParameters = network_parameters<Elements>();
    static constexpr int kStates = Elements;
    static constexpr bool kUsesAccel = false;

    enum { kC, kK, kF0 };
    enum { kYield, kRatio, kTravel, kCreep, kSlip, kKnee };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates) {
        T force = p[kC] * m.v + p[kK] * m.x + p[kF0];
        for (std::size_t e = 0; e < Elements; ++e) {
            const T *own = p + kNetworkShared + e * kNetworkPerElement;
            const T size = absolute(z[e]);
            const T beyond = size - own[kRatio];
            const T width = own[kKnee] * own[kRatio];
            const T at_rest = own[kRatio] * square_root(T(1.0) + own[kKnee] * own[kKnee]);
            const T yielding =
                T(0.5) * (square_root(beyond * beyond + width * width) + size - at_rest);
            rates[e] = m.v / own[kTravel] - z[e] / own[kCreep] -
                       with_sign_of(larger(yielding, T(0.0)), z[e]) / own[kSlip];
            force = force + own[kYield] * z[e];
        }
        return force;
    }

    template <class T>
    static T fastest_rate_1_s(const T *p, const T & /*speed_m_s*/) {
        T fastest = T(0.0);
        for (std::size_t e = 0; e < Elements; ++e) {
            const T *own = p + kNetworkShared + e * kNetworkPerElement;
            fastest = larger(fastest, T(1.0) / own[kCreep] + T(1.0) / own[kSlip]);
        }
        return fastest;
    }
    static double stiffest_N_s_m(const double *p) { return std::abs(p[kC]); }
    static double stiffest_N_m(const double *p) {
        double stiffness = std::abs(p[kK]);
        for (std::size_t e = 0; e < Elements; ++e) {
            stiffness += element(p, e)[kYield] / element(p, e)[kTravel];
        }
        return stiffness;
    }
    static bool is_passive(const double *p) {
        bool passive = p[kC] >= 0.0 && p[kK] >= 0.0;
        for (std::size_t e = 0; e < Elements; ++e) {
            passive = passive && element(p, e)[kYield] >= 0.0;
        }
        return passive;
    }

  private:
    static const double *element(const double *p, std::size_t e) {
        return p + kNetworkShared + e * kNetworkPerElement;
    }
};

struct ViscoplasticNetwork1 : ViscoplasticNetwork<1> {
    static constexpr const char *kName = "viscoplastic_1";
    static constexpr const char *kTitle = "viscoplastic network, 1 element";
};

struct ViscoplasticNetwork2 : ViscoplasticNetwork<2> {
    static constexpr const char *kName = "viscoplastic_2";
    static constexpr const char *kTitle = "viscoplastic network, 2 elements";
};

struct ViscoplasticNetwork3 : ViscoplasticNetwork<3> {
    static constexpr const char *kName = "viscoplastic_3";
    static constexpr const char *kTitle = "viscoplastic network, 3 elements";
};

struct ViscoplasticNetwork4 : ViscoplasticNetwork<4> {
    static constexpr const char *kName = "viscoplastic_4";
    static constexpr const char *kTitle = "viscoplastic network, 4 elements";
};

} // namespace quiesce

#endif
