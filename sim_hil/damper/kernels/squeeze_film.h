/// Squeeze-mode biviscosity model (Lin, Yau, Lee, Tung): a biviscous film between two discs.
///
///   h = gap + x,  tau1 = A_h H^b,  H = turns i / (2 pi coil_radius)
///   F = force_scale (2 pi tau1 a^3 / h) Psi(eta a |v| / (h^2 tau1)) sgn(v)
///
/// Psi: squeeze_psi.h. Identified are eta, gamma, A_h and b; the geometry is known of a damper. The
/// coil's numbers and A_h only count together: the paper does not print them. force_scale eta and
/// force_scale A_h do, too. The plant's damper of the same name reads Psi from a table
/// (squeeze_biviscosity.h). Static.
#ifndef QUIESCE_SQUEEZE_FILM_H
#define QUIESCE_SQUEEZE_FILM_H

#include "kernel.h"
#include "squeeze_film_law.h"
#include "squeeze_psi_lanes.h"

namespace quiesce {

struct SqueezeFilm {
    static constexpr const char *kName = "squeeze_biviscosity";
    static constexpr const char *kTitle = "squeeze-mode biviscosity";
    static constexpr const char *kSource = "Lin, Yau, Lee, Tung";
    static constexpr std::array<ParameterInfo, 9> kParameters{{
        {"plate_radius_m", "m", 1e-4, 1.0, 0.05, 0.2, kNoScale, false, false,
         "radius of the discs"},
        {"gap_m", "m", 1e-6, 0.1, 0.05, 0.09, kNoScale, false, false, "gap at rest"},
        {"coil_turns", "turns", 1.0, 1e6, 100.0, 2000.0, kNoScale, false, false,
         "turns of the coil"},
        {"coil_radius_m", "m", 1e-4, 10.0, 0.005, 0.1, kNoScale, false, false,
         "mean radius of the flux path"},
        {"viscosity_Pa_s", "Pa s", 1e-6, 1e4, 1e-3, 10.0, kNoScale, false, false,
         "eta: viscosity after yield"},
        {"viscosity_ratio", "-", 1e-12, 1.0, 1e-6, 1.0, kNoScale, false, false,
         "gamma: viscosity after over before yield"},
        {"yield_coefficient", "Pa/(A/m)^b", 0.0, 1e6, 1e-6, 1.0, kNoScale, false, false,
         "A_h: yield stress at a field of 1 A/m"},
        {"yield_exponent", "-", 0.1, 4.0, 0.5, 2.0, kNoScale, false, false,
         "b: of the field in the yield stress"},
        {"force_scale", "-", 0.0, 1e6, 1.0, 1.0, kNoScale, true, false,
         "part of the film's force that is measured"},
    }};
    /// The geometry: nothing searches its ranges, tests draw from them.
    static constexpr std::size_t kTold = 4;
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = false;

    enum { kRadius, kGap, kTurns, kCoilRadius, kEta, kGamma, kYield, kExponent, kScale };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T * /*z*/, T * /*rates*/) {
        const SqueezeFilmLaw<T> law = film(p);
        const T gap_m = larger(p[kGap] + m.x, T(kFilmLeastGap) * p[kGap]);
        const T field_A_m = p[kTurns] * absolute(m.i) / (T(kTwoPi) * p[kCoilRadius]);
        const T yield_Pa = p[kYield] * power(field_A_m, p[kExponent]);
        const T safe_Pa = larger(yield_Pa, T(kFilmNoYield_Pa));
        const T per_film = T(1.0) / (gap_m * gap_m * safe_Pa);
        const T psi = squeeze_psi_of(law.chi(absolute(m.v), per_film), p[kGamma]);
        const T yielded_N = with_sign_of(law.yielded_N(safe_Pa, gap_m, per_film, psi), m.v);
        return select(yield_Pa < T(kFilmNoYield_Pa), law.newtonian_N(m.v, gap_m), yielded_N);
    }

    template <class T>
    static T fastest_rate_1_s(const T * /*p*/, const T & /*speed_m_s*/) {
        return T(0.0);
    }
    /// Of the unyielded film at rest.
    static double stiffest_N_s_m(const double *p) {
        return film(p).newtonian_N(1.0, p[kGap]) / p[kGamma];
    }
    static double stiffest_N_m(const double * /*p*/) { return 0.0; }
    static bool is_passive(const double * /*p*/) { return true; }

  private:
    static constexpr double kTwoPi = 6.28318530717958647693;

    template <class T>
    static SqueezeFilmLaw<T> film(const T *p) {
        const T radius = p[kRadius];
        const T per_force = p[kScale] * T(kTwoPi) * cube(radius);
        return {p[kEta] * radius, per_force, T(0.75) * per_force * p[kEta] * radius};
    }
};

} // namespace quiesce

#endif
