/// Force of a squeezed film, one place for the plant's damper (squeeze_biviscosity.h) and for the
/// kernel that is identified (kernels/squeeze_film.h). Velocities, gap h, yield stress tau1 in SI.
#ifndef QUIESCE_SQUEEZE_FILM_LAW_H
#define QUIESCE_SQUEEZE_FILM_LAW_H

namespace quiesce {

/// Below this yield stress the film is Newtonian.
constexpr double kFilmNoYield_Pa = 1e-3;
/// The model ends at this part of the gap at rest, where nothing else is said.
constexpr double kFilmLeastGap = 0.01;

template <class T>
struct SqueezeFilmLaw {
    T wall_shear;  ///< eta a: chi = wall_shear |v| / (h^2 tau1)
    T yield_force; ///< force_scale 2 pi a^3
    T stefan;      ///< force_scale 3 pi eta a^4 / 2

    T newtonian_N(const T &velocity_m_s, const T &gap_m) const {
        return stefan * velocity_m_s / (gap_m * gap_m * gap_m);
    }
    /// per_film = 1 / (h^2 tau1).
    T chi(const T &speed_m_s, const T &per_film) const { return wall_shear * speed_m_s * per_film; }
    T yielded_N(const T &yield_Pa, const T &gap_m, const T &per_film, const T &psi) const {
        return yield_force * yield_Pa * yield_Pa * gap_m * per_film * psi;
    }
};

} // namespace quiesce

#endif
