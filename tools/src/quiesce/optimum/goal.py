"""What a current is judged by: steady-state figures relative to no current at all."""

from dataclasses import dataclass

from quiesce.optimum.periodic import Drive, Orbit, solve

# Far more than any other term gains by going beyond a limit; the amplitude's limit comes first.
ACCEL_PENALTY = 5.0
AMP_PENALTY = 200.0


@dataclass(frozen=True)
class Goal:
    """Minimise  amp A/A0 + accel a/a0 + current I/Imax  within limits of A/A0 and a/a0.

    A: half peak-to-peak displacement, a: RMS acceleration, A0 and a0 the same at 0 A, I: mean
    current. Where not both limits can be kept, the amplitude's is.
    """

    amp: float = 1.0
    accel: float = 0.0
    current: float = 0.0
    amp_limit: float = float("inf")
    accel_limit: float = float("inf")

    def cost(self, amp: float, accel: float, current: float) -> float:
        """Of figures relative to 0 A and to the full current."""
        return (
            self.amp * amp
            + self.accel * accel
            + self.current * current
            + AMP_PENALTY * max(0.0, amp - self.amp_limit)
            + ACCEL_PENALTY * max(0.0, accel - self.accel_limit)
        )


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
        current = orbit.mean_current_A / self.drive.plant.max_current_A
        return goal.cost(self.amp_ratio(orbit), self.accel_ratio(orbit), current)


def reference(drive: Drive) -> Reference:
    return Reference(drive, solve(drive, 0.0))
