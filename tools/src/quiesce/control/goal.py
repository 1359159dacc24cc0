"""What a current is judged by: steady-state figures relative to no current at all."""

from dataclasses import dataclass

from quiesce.control.periodic import Drive, Orbit, solve


@dataclass(frozen=True)
class Goal:
    """Minimise  amp A/A0 + accel a/a0 + current I/Imax  with a/a0 at most accel_limit.

    A: half peak-to-peak displacement, a: RMS acceleration, A0 and a0 the same at 0 A, I: mean
    current.
    """

    amp: float = 1.0
    accel: float = 0.0
    current: float = 0.0
    accel_limit: float | None = None

    PENALTY = 5.0  # of a/a0 beyond its limit: far more than any gain in amplitude can pay


AMP = Goal()
ACCEL = Goal(amp=0.0, accel=1.0)
NO_WORSE = Goal(accel_limit=1.0)


@dataclass(frozen=True)
class Reference:
    """The plant without current under the same excitation."""

    drive: Drive
    orbit: Orbit

    def amp_ratio(self, orbit: Orbit) -> float:
        return orbit.amp_m / self.orbit.amp_m

    def accel_ratio(self, orbit: Orbit) -> float:
        return orbit.accel_rms_m_s2 / self.orbit.accel_rms_m_s2

    def amp_reduction_pct(self, orbit: Orbit) -> float:
        return 100.0 * (1.0 - self.amp_ratio(orbit))

    def accel_reduction_pct(self, orbit: Orbit) -> float:
        return 100.0 * (1.0 - self.accel_ratio(orbit))

    def cost(self, goal: Goal, orbit: Orbit) -> float:
        """The goal's sum, with a steep penalty beyond the limit."""
        accel = self.accel_ratio(orbit)
        beyond = 0.0 if goal.accel_limit is None else max(0.0, accel - goal.accel_limit)
        return (
            goal.amp * self.amp_ratio(orbit)
            + goal.accel * accel
            + goal.current * orbit.mean_current_A / self.drive.plant.max_current_A
            + goal.PENALTY * beyond
        )


def reference(drive: Drive) -> Reference:
    return Reference(drive, solve(drive, 0.0))
