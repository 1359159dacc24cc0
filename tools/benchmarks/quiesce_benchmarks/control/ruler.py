"""What a law is measured against: the best that is known to be attainable.

The bound of a plant at a frequency is the best of its own optimal control (cached, committed), of
what any law has reached in this run, and, for the published plant, of the published table. It is a
best value found, not a proof, so that a law that goes beyond it raises it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from quiesce.hil.published import Reference, load_reference

from quiesce_benchmarks.control.optima import Optima
from quiesce_benchmarks.control.rig import Plant, Reduction

# Stored figures are rounded to 0.001; a limit of 0 may read as a little less.
ROUNDING_pct = 1e-3
STORED = ("amp_red_pct", "accel_red_pct", "mean_current_A")


@dataclass(frozen=True)
class Bound:
    """Reductions in %, each figure alone; None where not known."""

    amp_pct: float | None = None
    accel_pct: float | None = None
    balanced_amp_pct: float | None = None  # with acceleration no worse than at 0 A

    def raised(self, other: "Bound") -> "Bound":
        return Bound(*(best(pair) for pair in zip(values(self), values(other), strict=True)))


def values(bound: Bound) -> tuple[float | None, ...]:
    return (bound.amp_pct, bound.accel_pct, bound.balanced_amp_pct)


def best(candidates: Iterable[float | None]) -> float | None:
    return max((one for one in candidates if one is not None), default=None)


def reached(found: Sequence[Reduction]) -> Bound:
    """What laws have shown to be possible."""
    return Bound(
        best(one.amp_pct for one in found),
        best(one.accel_pct for one in found),
        best(one.amp_pct for one in found if one.accel_pct >= -ROUNDING_pct),
    )


def published(plant: Plant) -> dict[float, Bound]:
    """The table for the published plant at its drive; empty for any other."""
    reference: Reference = load_reference()
    if not reference.covers(plant.file, plant.drive_V):
        return {}
    return {freq_Hz: Bound(*pair) for freq_Hz, pair in reference.bounds.items()}


def stored(optima: Optima, plant: Plant, freq_Hz: float) -> Bound:
    """A current that is best for one figure shows what is possible of the others, too."""
    found = optima.reductions(plant.file, freq_Hz).values()
    return reached([Reduction(*(one[key] for key in STORED)) for one in found])


class Ruler:
    """Bounds of one plant and of its variations."""

    def __init__(self, plant: Plant, optima: Optima, freqs_Hz: Sequence[float]) -> None:
        """freqs_Hz: of the bench; the published table's are looked up as well."""
        self._optima = optima
        self._published = published(plant)
        wanted = sorted({*freqs_Hz, *self._published})
        self._own = {freq_Hz: stored(optima, plant, freq_Hz) for freq_Hz in wanted}
        self._reached: dict[float, Bound] = {}

    @property
    def is_published(self) -> bool:
        """The plant that the published figures and goals are about."""
        return bool(self._published)

    def learn(self, freq_Hz: float, found: Sequence[Reduction]) -> None:
        """Runs on the plant as it is. A bound needs an optimum or the table: what laws reached
        raises it but is none by itself."""
        self._reached[freq_Hz] = reached(found)

    def bound(self, freq_Hz: float) -> Bound:
        own = self._own.get(freq_Hz, Bound())
        known = own.raised(self._published.get(freq_Hz, Bound()))
        raised = known.raised(self._reached.get(freq_Hz, Bound()))
        pairs = zip(values(known), values(raised), strict=True)
        return Bound(*(None if base is None else top for base, top in pairs))

    def amp_pct_of(self, plant: Plant, freq_Hz: float, found_pct: float) -> float | None:
        """Bound of another plant, where what was found is not better."""
        own = stored(self._optima, plant, freq_Hz).amp_pct
        return None if own is None else max(own, found_pct)

    def amp_grid(self, band_Hz: tuple[float, float]) -> tuple[list[float], list[float]] | None:
        """Frequencies and amplitude bounds that cover a band; None where they do not."""
        known = [(freq_Hz, self.bound(freq_Hz).amp_pct) for freq_Hz in sorted(self._own)]
        grid = [(freq_Hz, pct) for freq_Hz, pct in known if pct is not None]
        if not grid or grid[0][0] > band_Hz[0] or grid[-1][0] < band_Hz[1]:
            return None
        return [freq_Hz for freq_Hz, _ in grid], [pct for _, pct in grid]

    def lacking_Hz(self) -> list[float]:
        """Frequencies without own optimal control."""
        return [freq_Hz for freq_Hz, own in self._own.items() if own.amp_pct is None]

    def own_under(self) -> list[dict[str, Any]]:
        """Own optimal control beside the published table, where both are known."""
        rows = []
        for freq_Hz, table in sorted(self._published.items()):
            own = self._own[freq_Hz]
            if own.amp_pct is None or own.accel_pct is None:
                continue
            assert table.amp_pct is not None and table.accel_pct is not None
            under = max(table.amp_pct - own.amp_pct, table.accel_pct - own.accel_pct)
            rows.append(
                {
                    "freq_Hz": freq_Hz,
                    "own": asdict(own),
                    "published": asdict(table),
                    "under_pts": under,
                }
            )
        return rows

    def worst_under_pts(self) -> float | None:
        """None unless every frequency of the table has an own optimum."""
        rows = self.own_under()
        if not rows or len(rows) < len(self._published):
            return None
        return max(row["under_pts"] for row in rows)
