"""A damper's map as the controller takes it: words of integers, for tracker `inverse`.

firmware/track/force_map.h describes the words; it checks them again.
"""

import struct
import zlib

import numpy as np

from quiesce.damper.inverse import Monotone, SteadyForces

MAGIC = 0x31464D51
MAX_CURRENTS = 16
MAX_CURRENT_mA = 20000
LIMIT = 2**30 - 1  # of a force in mN and of a velocity in um/s
# Forces are whole mN: less than this between no current and the largest one is told too coarsely.
LEAST_RANGE_mN = 100


def why_no_map(found: Monotone) -> str:
    """One line; empty where there is a map."""
    forces = found.forces
    slowest = int(np.argmin(found.per_velocity_A))
    most_mA = top_mA(found)
    largest_N = float(np.abs(forces.force_N).max())
    if most_mA < 1:
        speed = forces.velocities_m_s[slowest]
        return f"at {speed:.4g} m/s the force falls with the current from 0 A on"
    if most_mA > MAX_CURRENT_mA:
        return f"{most_mA / 1e3:g} A is more than {MAX_CURRENT_mA / 1e3:g} A; --max-current-A"
    if 1e3 * largest_N > LIMIT:
        return f"a force of {largest_N:.4g} N is more than {LIMIT / 1e3:.0f} N"
    if not _is_axis(_velocities_um_s(forces)):
        return "its velocities do not differ by whole um/s both ways, or pass 1073 m/s"
    spread_mN = float(1e3 * np.ptp(_resampled_N(found), axis=1).max())
    if spread_mN < LEAST_RANGE_mN:
        return (
            f"the current changes the force by {spread_mN:.3g} mN at most, and forces are whole mN"
        )
    return ""


def map_words(found: Monotone) -> list[int]:
    """What the firmware loads, up to the current where some force stops rising. ValueError where
    `why_no_map` says something."""
    if why := why_no_map(found):
        raise ValueError(why)
    velocities, currents = _velocities_um_s(found.forces), _currents_mA(found)
    # What integration and rounding leave of a fall is less than a part in a million: levelled.
    along = np.maximum.accumulate(np.rint(1e3 * _resampled_N(found)).astype(int), axis=1)
    forces = np.sign(velocities)[:, None] * along  # > 0 resists a stroke that grows
    values = [int(value) for part in (velocities, currents, forces.ravel()) for value in part]
    after = [5 + len(values), len(velocities), len(currents)]
    after += [value & 0xFFFFFFFF for value in values]
    return [MAGIC, zlib.crc32(struct.pack(f"<{len(after)}I", *after)), *after]


def top_mA(found: Monotone) -> int:
    """The largest current of the map."""
    return int(1e3 * found.limit_A * (1.0 + 1e-12))


def _velocities_um_s(forces: SteadyForces) -> np.ndarray:
    return np.rint(1e6 * forces.velocities_m_s).astype(int)


def _is_axis(velocities_um_s: np.ndarray) -> bool:
    return bool(
        (np.diff(velocities_um_s) > 0).all()
        and -LIMIT <= velocities_um_s[0] < 0 < velocities_um_s[-1] <= LIMIT
    )


def _currents_mA(found: Monotone) -> np.ndarray:
    return np.unique(np.rint(np.linspace(0.0, top_mA(found), MAX_CURRENTS)).astype(int))


def _resampled_N(found: Monotone) -> np.ndarray:
    """In the direction of the motion, at the map's currents."""
    currents_A = 1e-3 * _currents_mA(found)
    forces = found.forces
    return np.stack([np.interp(currents_A, forces.currents_A, row) for row in forces.force_N])
