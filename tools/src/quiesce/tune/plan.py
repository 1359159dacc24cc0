"""What `quiesce tune` computes: frequencies, weights, variants of the plant, and how thoroughly."""

import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from quiesce.base import paths
from quiesce.base.errors import UsageError
from quiesce.optimum.bound import INTERVALS, STARTS
from quiesce.plant.library import Plant
from quiesce.plant.variant import Variant
from quiesce.tune.phase_table import FEWEST_POINTS, MOST_POINTS, SETTINGS
from quiesce.tune.setting import BALANCED, DISPLACEMENT, Setting

# The band of a table, in parts of the first mode's frequency.
FROM_PART, TO_PART = 0.35, 2.0
USUAL_POINTS, QUICK_POINTS = 40, 6
QUICK_FROM_PART = 0.45  # below it optimisation takes longest
# What the firmware's tracker reports.
LOWEST_Hz, HIGHEST_Hz = 1.0, 50.0
LEAST_MODE_Hz = 0.01  # below it a mode is a structure that is free to move
ROUND_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
# Where fronts and robustness are shown, in parts of the first mode's frequency.
SHOWN_PARTS = (0.45, 0.87, 1.3, 1.75)

SHIPPED = dict(zip(SETTINGS, (DISPLACEMENT, BALANCED), strict=True))

FORCES, LAGS, FREQS, DRIVES = (0.7, 1.0, 1.5), (0.4, 1.0, 2.0), (0.9, 1.0, 1.1), (0.9, 1.0, 1.2)


@dataclass(frozen=True)
class Quality:
    """How thoroughly bounds are searched, and how many points a front has between its ends."""

    intervals: int
    starts: int
    front_points: int


FINE, QUICK = Quality(INTERVALS, STARTS, 5), Quality(30, 2, 2)


@dataclass(frozen=True)
class Band:
    """Frequencies of a table; None: from the plant's modes."""

    from_Hz: float | None = None
    to_Hz: float | None = None
    step_Hz: float | None = None


@dataclass(frozen=True)
class TunePlan:
    plant: Path
    freqs_Hz: tuple[float, ...]
    shown_Hz: tuple[float, ...]  # where fronts and robustness are looked at
    settings: dict[str, Setting]  # by name
    quality: Quality
    variants: tuple[Variant, ...]  # the first one is the plant as it is; empty: no robustness

    def inputs(self) -> dict[str, Any]:
        """What all stored pieces depend on, but for the plant."""
        return {"quality": asdict(self.quality)}


def make_plan(
    plant: Plant, band: Band, settings: dict[str, Setting], robustness: str, is_quick: bool
) -> TunePlan:
    """UsageError, naming the option, for a band that no table can have."""
    freqs_Hz = frequencies(plant, band, is_quick)
    shown_Hz = shown(freqs_Hz, plant.modes[0].freq_Hz)
    return TunePlan(
        plant.file,
        freqs_Hz,
        (shown_Hz[0], shown_Hz[-1])[: len(shown_Hz)] if is_quick else shown_Hz,
        settings,
        QUICK if is_quick else FINE,
        variants(plant, robustness),
    )


def frequencies(plant: Plant, band: Band, is_quick: bool) -> tuple[float, ...]:
    first_Hz = plant.modes[0].freq_Hz
    if not first_Hz > LEAST_MODE_Hz and None in (band.from_Hz, band.to_Hz):
        raise UsageError(
            f"{paths.shown(plant.file)}: without damper and mounts its first mode is at 0 Hz, "
            "which tells no band: name it, --from-Hz and --to-Hz"
        )
    from_part = QUICK_FROM_PART if is_quick else FROM_PART
    points = QUICK_POINTS if is_quick else USUAL_POINTS
    low_Hz = band.from_Hz if band.from_Hz is not None else max(LOWEST_Hz, from_part * first_Hz)
    high_Hz = band.to_Hz if band.to_Hz is not None else min(HIGHEST_Hz, TO_PART * first_Hz)
    _require_band(low_Hz, high_Hz, band.step_Hz)
    grid_Hz = round_step((high_Hz - low_Hz) / (USUAL_POINTS - 1))
    if band.from_Hz is None:
        low_Hz = max(LOWEST_Hz, grid_Hz * math.floor(low_Hz / grid_Hz + 1e-9))
    step_Hz = band.step_Hz or grid_Hz * math.ceil((high_Hz - low_Hz) / (grid_Hz * points) - 1e-9)
    if band.to_Hz is None:
        high_Hz = low_Hz + step_Hz * math.ceil((high_Hz - low_Hz) / step_Hz - 1e-9)
        high_Hz -= step_Hz if high_Hz > HIGHEST_Hz else 0.0
    count = math.floor((high_Hz - low_Hz) / step_Hz + 1e-9) + 1
    if not FEWEST_POINTS <= count <= MOST_POINTS:
        raise UsageError(
            f"--step-Hz {step_Hz:g}: {count} frequencies from {low_Hz:g} to {high_Hz:g} Hz; "
            f"a table has {FEWEST_POINTS} to {MOST_POINTS}"
        )
    return tuple(round(low_Hz + i * step_Hz, 6) for i in range(count))


def _require_band(low_Hz: float, high_Hz: float, step_Hz: float | None) -> None:
    for option, value_Hz in (("--from-Hz", low_Hz), ("--to-Hz", high_Hz)):
        if not LOWEST_Hz <= value_Hz <= HIGHEST_Hz:
            raise UsageError(
                f"{option} {value_Hz:g}: the controller tracks {LOWEST_Hz:g} to {HIGHEST_Hz:g} Hz"
            )
    if low_Hz >= high_Hz:
        raise UsageError(f"--from-Hz {low_Hz:g} --to-Hz {high_Hz:g}: the first must be lower")
    if step_Hz is not None and not 0.001 <= step_Hz <= high_Hz - low_Hz:
        raise UsageError(f"--step-Hz {step_Hz:g}: expected 0.001 .. {high_Hz - low_Hz:g} Hz")


def round_step(about_Hz: float) -> float:
    """The round number that is next to it: 1, 2, 2.5 or 5 times a power of ten."""
    scale = 10.0 ** math.floor(math.log10(about_Hz))
    return min((scale * part for part in ROUND_STEPS), key=lambda step: abs(step / about_Hz - 1.0))


def shown(freqs_Hz: tuple[float, ...], first_Hz: float) -> tuple[float, ...]:
    """Of the table's frequencies, those next to the parts of the first mode that tell most."""
    nearest = {min(freqs_Hz, key=lambda f: abs(f - part * first_Hz)) for part in SHOWN_PARTS}
    return tuple(sorted(nearest))


def variants(plant: Plant, robustness: str) -> tuple[Variant, ...]:
    """none; axes: one property at a time; full: all combinations."""
    if robustness == "none":
        return ()
    rises_s = [_rounded(part * plant.rise_s) for part in LAGS]
    drives_V = [_rounded(part * plant.drive_V) for part in DRIVES]
    whole = [
        Variant(rise_s=rise_s, force=force, freq=freq, drive_V=drive_V)
        for rise_s in rises_s
        for force in FORCES
        for freq in FREQS
        for drive_V in drives_V
    ]
    if robustness == "full":
        nominal = Variant(rise_s=rises_s[1], drive_V=drives_V[1])
        return (Variant(), *(one for one in whole if one != nominal))
    return (
        Variant(),
        *(Variant(force=force) for force in FORCES if force != 1.0),
        *(Variant(rise_s=rise_s) for rise_s in (rises_s[0], rises_s[2])),
        *(Variant(freq=freq) for freq in FREQS if freq != 1.0),
        *(Variant(drive_V=drive_V) for drive_V in (drives_V[0], drives_V[2])),
    )


def _rounded(value: float) -> float:
    """To a number that can be told in a name."""
    return float(f"{value:.3g}")


def chosen_settings(weights: list[str], limits: list[str]) -> dict[str, Setting]:
    """The shipped settings with --weights and --accel-limit applied. UsageError names the option.

    Own weights are free of the shipped limits: they alone decide.
    """
    settings = dict(SHIPPED)
    for text in weights:
        name, numbers = _assignment("--weights", text, 3)
        if min(numbers) < 0.0 or numbers[0] + numbers[1] <= 0.0:
            raise UsageError(f"--weights {text}: 0 or more, not both of the first two 0")
        settings[name] = Setting(
            *numbers,
            fraction=0.0,
            accel_limit=math.inf,
            of_no_worse=settings[name].of_no_worse,
            fraction_alone=None,
            constant_slack_pts=math.inf,
        )
    for text in limits:
        name, (percent,) = _assignment("--accel-limit", text, 1)
        if percent <= 0.0:
            raise UsageError(f"--accel-limit {text}: more than 0 % of the uncontrolled")
        settings[name] = replace(settings[name], accel_limit=percent / 100.0)
    return settings


def _assignment(option: str, text: str, count: int) -> tuple[str, list[float]]:
    name, _, values = text.partition("=")
    if name not in SHIPPED:
        raise UsageError(f"{option} {text}: no setting {name!r}; there are: {', '.join(SHIPPED)}")
    try:
        numbers = [float(value) for value in values.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(math.isfinite(number) for number in numbers):
        what = "DISPLACEMENT,ACCELERATION,CURRENT" if count == 3 else "PERCENT"
        raise UsageError(f"{option} {text}: expected {name}={what}")
    return name, numbers
