"""Changes of frequency: how soon the vibration settles and how far it swings."""

from dataclasses import asdict, dataclass
from typing import Any

from quiesce.engine.trace import Trace

from quiesce_benchmarks.control.rig import DISPLACEMENT, OPEN_LOOP, SETTINGS, Control, Rig, constant
from quiesce_benchmarks.control.scenarios import step

EARLY_s, LATE_s = 4.0, 64.0  # when the frequency changes: cold, and after adaptation
CHANGES_Hz = ((10.0, 20.0), (5.0, 10.0))
COLUMNS = ("t_s", "x5_um", "coil_A", "freq_uHz", "freq_is_valid")


@dataclass(frozen=True)
class StepResult:
    from_Hz: float
    to_Hz: float
    at_s: float
    control: str  # a setting of the law, or what it is compared with
    settle_s: float | None  # None: not within 6 s
    rms_disp_um: float  # in the 2 s after the change
    peak_um: float  # in the same 2 s
    mean_current_A: float  # in the last 2 s
    trace: Trace

    def row(self) -> dict[str, Any]:
        return {key: value for key, value in asdict(self).items() if key != "trace"}


def controls(rig: Rig) -> dict[str, Control]:
    return {
        **{setting: rig.judged.control(setting) for setting in SETTINGS},
        "fuzzy": Control("fuzzy"),
        "constant": constant(rig.full_A),
        "open loop": OPEN_LOOP,
    }


def measure_step(rig: Rig, from_Hz: float, to_Hz: float, at_s: float, name: str) -> StepResult:
    run = rig.run(step(from_Hz, to_Hz, at_s), controls(rig)[name], columns=COLUMNS)
    assert run.trace is not None
    return StepResult(
        from_Hz, to_Hz, at_s, name,
        run.figures["settle_s"],
        run.figures["rms_disp_um"],
        run.figures["transient_peak_disp_um"],
        run.figures["mean_current_A"],
        run.trace,
    )  # fmt: skip


def find(results: list[StepResult], to_Hz: float, name: str = DISPLACEMENT) -> StepResult:
    """The change at 4 s: the one with goals."""
    return next(
        one for one in results if (one.to_Hz, one.at_s, one.control) == (to_Hz, EARLY_s, name)
    )
