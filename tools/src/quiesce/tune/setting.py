"""What a setting of the phase law asks for: weights and limits that hold at every frequency."""

from dataclasses import dataclass, replace

from quiesce.optimum.goal import Goal


@dataclass(frozen=True)
class Setting:
    """Minimise the weighted sum of relative displacement, acceleration and current, with at least
    `fraction` of a bound's reduction of the displacement, at most `constant_slack_pts` below the
    full constant current's, and accelerations up to `accel_limit`.

    The bound is that of the displacement alone, or with acceleration no worse than uncontrolled
    (`of_no_worse`). Where one pulse cannot keep all of this, the displacement comes first with
    `fraction_alone` of its bound, or, where that is None, the acceleration comes first.
    """

    amp: float
    accel: float
    current: float
    fraction: float
    accel_limit: float  # of RMS acceleration over that at 0 A
    of_no_worse: bool
    fraction_alone: float | None
    constant_slack_pts: float = 0.4
    adapt_weight: float | None = None  # of acceleration where the firmware adapts the pulse; None:
    # the one for which the pulse is the best on the plant that it was made for

    def first(self, marks: "Marks") -> Goal:
        """All limits."""
        constant_pct = marks.constant_pct - self.constant_slack_pts
        return Goal(
            amp=self.amp,
            accel=self.accel,
            current=self.current,
            amp_limit=_ratio(max(self.fraction * marks.bound_pct, constant_pct, 0.0)),
            accel_limit=self.accel_limit,
        )

    def second(self, marks: "Marks") -> Goal:
        """Where the first goal's limits cannot be kept together."""
        if self.fraction_alone is None:
            return replace(self.first(marks), accel=0.0, amp_limit=float("inf"))
        limit = _ratio(max(self.fraction_alone * marks.bound_pct, 0.0))
        return replace(self.first(marks), amp_limit=limit)


@dataclass(frozen=True)
class Marks:
    """Reductions of displacement at one frequency that a setting is measured by."""

    bound_pct: float  # the one that its fractions are of
    constant_pct: float  # of the full constant current, where its acceleration is within the limit


def _ratio(reduction_pct: float) -> float:
    return 1.0 - reduction_pct / 100.0


DISPLACEMENT = Setting(
    amp=1.0,
    accel=1.0,
    current=0.02,
    fraction=0.897,
    accel_limit=1.006,
    of_no_worse=False,
    fraction_alone=0.94,
    constant_slack_pts=0.9,
    adapt_weight=0.05,
)
BALANCED = Setting(
    amp=1.0,
    accel=1.0,
    current=0.02,
    fraction=0.91,
    accel_limit=1.005,
    of_no_worse=True,
    fraction_alone=None,
)
