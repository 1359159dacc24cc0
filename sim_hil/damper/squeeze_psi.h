/// Psi(chi): dimensionless force of a biviscous fluid squeezed between two discs.
///
///   S = chi r/a     wall shear scale at radius r, chi = eta a |v| / (h^2 tau1)
///   G(S)            wall stress over yield stress: 3 S/gamma while S <= gamma/3 (film unyielded),
///   else
///                   the largest root of G^3 - 3 (S + (1-gamma)/2) G^2 + (1-gamma)/2 = 0
///   Psi(chi)        = chi^-3 * integral of S^2 G dS over 0 .. chi
///
/// gamma = eta / eta_r in (0, 1] is the ratio of post-yield to pre-yield viscosity. Limits: gamma =
/// 1 or chi >> 1 Newtonian (Psi -> 3 chi/4), gamma << chi << 1 Bingham (Psi -> 1/3).
#ifndef QUIESCE_SQUEEZE_PSI_H
#define QUIESCE_SQUEEZE_PSI_H

#include <cstdint>
#include <cstring>
#include <vector>

namespace quiesce {

/// G - 1 for a film beyond its yield point by excess = S - gamma/3 >= 0 (no cancellation near it).
double squeeze_wall_excess(double excess, double gamma);

/// Psi by Gauss-Legendre quadrature over dG in panels of equal ratio; every term of the sum is
/// positive, so that nothing cancels. Accurate to about 1e-14 relative. chi >= 0.
double squeeze_psi_quadrature(double chi, double gamma);

/// Psi by its antiderivative. Loses digits to cancellation for small chi and gamma (4e-4 at
/// gamma = 1e-4): a check of the quadrature where both are well conditioned.
double squeeze_psi_closed_form(double chi, double gamma);

/// Psi for one gamma, fast: within 1e-10 relative of the quadrature for every chi >= 0.
///
/// Exact for chi <= gamma/3, asymptote for large chi, and between them quintic Hermite pieces over
/// the distance from the yield point. That variable (and not chi) makes Psi smooth: just past yield
/// it bends within a distance of gamma^2. Pieces are found from the exponent and the leading
/// mantissa bits of the distance, sixteen to the octave.
class SqueezePsi {
  public:
    explicit SqueezePsi(double gamma);

    double operator()(double chi) const;

  private:
    struct Piece {
        double start;     ///< distance from yield at which it starts
        double inv_width; ///< 1 / its length
        double c[6];      ///< polynomial in (distance - start) * inv_width
    };

    /// Pieces per octave: 2^kMantissaBits.
    static constexpr int kMantissaBits = 4;

    /// Beyond this chi the asymptote is within 1e-11; a power of two.
    static constexpr double kAsymptoteFrom = 1024.0;

    /// Exponent and leading mantissa bits of a positive number, as one integer; and the smallest
    /// number with an index.
    static std::uint64_t octave_index(double x);
    static double octave_start(std::uint64_t index);

    Piece fit_piece(double start, double end) const;
    double asymptote(double chi) const;

    double gamma_;
    double yield_chi_;   ///< gamma/3
    double yield_slope_; ///< dPsi/dchi up to the yield point
    double linear_to_;   ///< distance up to which the pre-yield line still holds
    std::uint64_t first_index_ = 0;
    std::vector<Piece> pieces_;
};

inline std::uint64_t SqueezePsi::octave_index(double x) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    return bits >> (52 - kMantissaBits);
}

inline double SqueezePsi::operator()(double chi) const {
    const double distance = chi - yield_chi_;
    if (distance < linear_to_) {
        return yield_slope_ * chi;
    }
    if (chi >= kAsymptoteFrom) {
        return asymptote(chi);
    }
    const Piece &piece = pieces_[octave_index(distance) - first_index_];
    const double t = (distance - piece.start) * piece.inv_width;
    const double t2 = t * t;
    const double *c = piece.c;
    return (c[0] + c[1] * t) + t2 * ((c[2] + c[3] * t) + t2 * (c[4] + c[5] * t));
}

} // namespace quiesce

#endif
