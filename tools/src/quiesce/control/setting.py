"""What a setting of the phase law asks for: weights and limits that hold at every frequency."""

from dataclasses import dataclass, replace

from quiesce.control.goal import Goal


@dataclass(frozen=True)
class Setting:
    """Minimise the weighted sum of relative displacement, acceleration and current, with at least
    `fraction` of a bound's reduction of the displacement and accelerations up to `accel_limit`.

    The bound is that of the displacement alone, or with acceleration no worse than uncontrolled
    (`of_no_worse`). Where one pulse cannot keep both, the displacement comes first with
    `fraction_alone` of its bound, or, where that is None, the acceleration comes first.
    """

    amp: float
    accel: float
    current: float
    fraction: float
    accel_limit: float  # of RMS acceleration over that at 0 A
    of_no_worse: bool
    fraction_alone: float | None

    def first(self, bound_pct: float) -> Goal:
        """Both limits. bound_pct: the reduction that `fraction` is of."""
        return Goal(
            amp=self.amp,
            accel=self.accel,
            current=self.current,
            amp_limit=_limit(self.fraction, bound_pct),
            accel_limit=self.accel_limit,
        )

    def second(self, bound_pct: float) -> Goal:
        """Where the first goal's limits cannot both be kept."""
        if self.fraction_alone is None:
            return replace(self.first(bound_pct), accel=0.0, amp_limit=float("inf"))
        return replace(self.first(bound_pct), amp_limit=_limit(self.fraction_alone, bound_pct))


def _limit(fraction: float, bound_pct: float) -> float:
    return 1.0 - fraction * max(bound_pct, 0.0) / 100.0


DISPLACEMENT = Setting(
    amp=1.0,
    accel=0.7,
    current=0.02,
    fraction=0.905,
    accel_limit=1.01,
    of_no_worse=False,
    fraction_alone=0.94,
)
BALANCED = Setting(
    amp=1.0,
    accel=1.0,
    current=0.02,
    fraction=0.93,
    accel_limit=0.998,
    of_no_worse=True,
    fraction_alone=None,
)
