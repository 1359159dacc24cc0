"""Figures of `quiesce hil`: reductions against open loop, beside the references."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from quiesce.engine.laws import OPEN_LOOP, published_law
from quiesce.hil.published import Published, Reference
from quiesce.hil.rig import RigRow
from quiesce.hil.runs import Run, displacement_um, reduction_pct


@dataclass(frozen=True)
class Row:
    """One steady state of one run; the fields are those of metrics.json's `runs`.

    A step has two: settle_s and rms_disp_um then describe the transition and stand in both.
    Where the excitation has no one frequency, freq_hz is 0 and the reduction of the amplitude is
    that of the RMS displacement.
    """

    scenario: str
    law: str
    target: str
    freq_hz: float
    amp_reduction_pct: float | None
    accel_rms_reduction_pct: float | None
    mean_current_A: float
    bound_amp_pct: float | None
    bound_accel_rms_pct: float | None
    settle_s: float | None
    rms_disp_um: float
    instr_median: int | None
    instr_worst: int | None
    faults: int
    seed: int
    noise_mg: float
    drive_V: float


@dataclass(frozen=True)
class OpenLoop:
    """What a row's reductions are against, ours and in the independent simulation."""

    amp_um: float
    accel_rms_mm_s2: float
    simulated: dict[str, float]


@dataclass(frozen=True)
class Beside:
    """What stands beside a row: None or empty where there is nothing."""

    published: Published | None
    simulated: dict[str, float]
    open_loop: OpenLoop


@dataclass(frozen=True)
class Warned:
    """What of a run a law's table does not cover, as the bench says it."""

    scenario: str
    law: str
    text: str


@dataclass(frozen=True)
class Result:
    """All that a `quiesce hil` found out."""

    rows: list[Row]
    beside: list[Beside]  # of each row
    published: Sequence[Published]
    trace_equal: dict[str, Any] | None
    differing: list[str]  # cases whose telemetry differs between host and image
    realtime_factor: dict[str, float | None]
    uart: dict[str, Any] | None
    rigs: Sequence[RigRow] = ()
    warnings: Sequence[Warned] = ()

    @property
    def plain(self) -> list[tuple[Row, Beside]]:
        """Rows, with what stands beside them, of scenarios without a board."""
        rigs = {row.scenario for row in self.rigs}
        pairs = zip(self.rows, self.beside, strict=True)
        return [(row, beside) for row, beside in pairs if row.scenario not in rigs]

    @property
    def is_equal(self) -> bool:
        """Host and image answered bit for bit the same wherever both ran."""
        return not self.differing and not (self.trace_equal and self.trace_equal["mismatches"])


def excitation_text(freq_Hz: float) -> str:
    return f"{freq_Hz:g} Hz" if freq_Hz > 0.0 else "no one frequency"


def mean_current_A(run: Run, window: int) -> float:
    """The bench gives the last window; an earlier one comes from the trace."""
    windows = run.case.scenario.windows_s
    if window >= len(windows) - 1:
        return run.figures["mean_current_A"]
    start_s, end_s = windows[window]
    time_s = run.trace["t_s"]
    return float(run.trace["coil_A"][(time_s >= start_s) & (time_s < end_s)].mean())


def make_row(run: Run, open_loop: Run, reference: Reference | None, window: int) -> Row:
    number = "" if window == 0 else "2"
    ours, base = run.figures, open_loop.figures
    freq_Hz = ours[f"freq{number}_hz"]
    bound = reference.bound(freq_Hz) if reference else None
    return Row(
        scenario=run.case.scenario.name,
        law=run.case.law.name,
        target=run.case.target,
        freq_hz=freq_Hz,
        amp_reduction_pct=reduction_pct(
            displacement_um(ours, number), displacement_um(base, number)
        ),
        accel_rms_reduction_pct=reduction_pct(
            ours[f"accel_rms{number}_mm_s2"], base[f"accel_rms{number}_mm_s2"]
        ),
        mean_current_A=round(mean_current_A(run, window), 4),
        bound_amp_pct=bound[0] if bound else None,
        bound_accel_rms_pct=bound[1] if bound else None,
        settle_s=None if ours["settle_s"] is None else round(ours["settle_s"], 4),
        rms_disp_um=round(ours["rms_disp_um"], 4),
        **{
            key: ours[key]
            for key in ("instr_median", "instr_worst", "faults", "seed", "noise_mg", "drive_V")
        },
    )


def make_rows(runs: Sequence[Run], reference: Reference) -> tuple[list[Row], list[Beside]]:
    """Rows of all runs. Each target is measured against its own open loop."""
    base = {(r.case.scenario.name, r.case.target): r for r in runs if r.case.law.name == OPEN_LOOP}
    rows, beside = [], []
    for run in runs:
        scenario = run.case.scenario
        known = reference.covers(scenario.plant_file, run.figures["drive_V"])
        for window in range(2 if run.figures["freq2_hz"] is not None else 1):
            open_loop = base[scenario.name, run.case.target]
            row = make_row(run, open_loop, reference if known else None, window)
            rows.append(row)
            beside.append(find_beside(row, open_loop, reference if known else None, window))
    return rows, beside


def find_beside(row: Row, open_loop: Run, reference: Reference | None, window: int) -> Beside:
    number = "" if window == 0 else "2"
    base = OpenLoop(
        displacement_um(open_loop.figures, number),
        open_loop.figures[f"accel_rms{number}_mm_s2"],
        reference.simulated_for(row.scenario, OPEN_LOOP, row.freq_hz) if reference else {},
    )
    if reference is None:
        return Beside(None, {}, base)
    # What was published for self-tuning stands beside every reading of it.
    return Beside(
        reference.published_for(row.scenario, published_law(row.law), row.freq_hz),
        reference.simulated_for(row.scenario, row.law, row.freq_hz),
        base,
    )


def differing_cases(runs: Sequence[Run]) -> list[str]:
    """Cases whose telemetry is not the same, bit for bit, on every target that ran them."""
    checksums: dict[str, set[int]] = {}
    for run in runs:
        name = f"{run.case.scenario.name} {run.case.law.name}"
        checksums.setdefault(name, set()).add(run.figures["telemetry_crc32"])
    return [name for name, found in checksums.items() if len(found) > 1]


def warnings_of(runs: Sequence[Run]) -> list[Warned]:
    """Of all runs, each once: targets answer alike."""
    found = [
        Warned(run.case.scenario.name, run.case.law.name, text)
        for run in runs
        for text in run.figures["warnings"]
    ]
    return list(dict.fromkeys(found))


def published_json(cases: Sequence[Published]) -> list[dict[str, Any]]:
    """metrics.json has one figure an entry: a range becomes two."""
    entries = []
    for case in cases:
        is_range = case.low_pct != case.high_pct
        ends = [("", case.low_pct)]
        if is_range:
            ends = [(", low end of the range", case.low_pct)]
            ends.append((", high end of the range", case.high_pct))
        for suffix, figure_pct in ends:
            entries.append(
                {
                    "case": case.scenario + suffix,
                    "law": case.law,
                    "freq_hz": case.freq_Hz,
                    "amp_reduction_pct": figure_pct,
                    "source": case.source,
                }
            )
    return entries


def metrics_json(result: Result) -> dict[str, Any]:
    """The object of metrics.json."""
    keys = ("ticks", "mismatches", "distinct_commands", "seeds", "targets")
    equal = result.trace_equal
    return {
        "runs": [asdict(row) for row in result.rows],
        "published": published_json(result.published),
        "trace_equal": {key: equal[key] for key in keys} if equal else None,
        "realtime_factor": {
            name: None if factor is None else round(factor, 2)
            for name, factor in result.realtime_factor.items()
        },
        "warnings": [asdict(one) for one in result.warnings],
        **({"rigs": [asdict(row) for row in result.rigs]} if result.rigs else {}),
    }


def amplitude_spectrum(trace: dict[str, np.ndarray], start_s: float, end_s: float):
    """Frequencies and amplitudes (Hann) of the true acceleration between two times, mm/s2."""
    time_s = trace["t_s"]
    values = trace["a5_mm_s2"][(time_s >= start_s) & (time_s < end_s)]
    window = np.hanning(len(values) + 1)[:-1]
    spectrum = np.fft.rfft(values * window) * 2.0 / window.sum()
    return np.fft.rfftfreq(len(values), time_s[1] - time_s[0]), np.abs(spectrum)
