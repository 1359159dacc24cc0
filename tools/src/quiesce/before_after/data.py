"""A report as JSON (docs/reference/report-files.md)."""

from typing import Any

import numpy as np

from quiesce.before_after import thirds
from quiesce.before_after.figures import Answer, Figure, Found, peak_of
from quiesce.before_after.files.source import Source
from quiesce.before_after.levels import Ratio, ratio
from quiesce.before_after.limits import Verdict
from quiesce.before_after.pairs import SIDES, Side
from quiesce.before_after.run import Report
from quiesce.before_after.words import headline

SCHEMA, VERSION = "quiesce-before-after", 1
DIGITS = 6


def as_data(report: Report) -> dict[str, Any]:
    low_Hz, high_Hz = report.settings.band_Hz
    machine = report.settings.machine
    return {
        "schema": SCHEMA,
        "version": VERSION,
        "title": report.title,
        "band_Hz": [rounded(low_Hz), rounded(high_Hz)],
        "machine": machine and {"name": machine.name, "boundaries_mm_s": machine.boundaries_mm_s},
        "reference": report.reference and report.reference.name,
        "files": {
            side: _source(source, digest)
            for side, source, digest in zip(SIDES, report.sources, report.hashes, strict=True)
        },
        "changed_parameters": [
            {"name": name, "before": before, "after": after}
            for name, before, after in report.changed_parameters
        ],
        "channels": [_channel(one, report.settings.band_Hz) for one in report.channels],
        "limits": [_verdict(one) for one in report.verdicts],
        "passed": report.is_kept if report.verdicts else None,
        "doubts": report.doubts,
    }


def rounded(value: float) -> float | None:
    """Six digits that count; None for what is no number."""
    return float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None


def _list(values: np.ndarray) -> list[float | None]:
    return [rounded(value) for value in values.tolist()]


def _source(source: Source, digest: str) -> dict[str, Any]:
    origin = source.origin
    return {
        "name": source.file.name, "sha256": digest, "kind": origin.kind,
        "facts": dict(origin.facts), "parameters": dict(origin.parameters),
    }  # fmt: skip


def _channel(found: Found, band_Hz: tuple[float, float]) -> dict[str, Any]:
    motion = found.pair.motion
    freq_Hz, *densities = found.spectra[0].freq_Hz, *(one.density() for one in found.spectra)
    return {
        "name": found.pair.name,
        "motion": motion.name,
        "unit": motion.unit,
        "headline": headline(found),
        "samples": {side: _samples(one) for side, one in zip(SIDES, found.pair.sides, strict=True)},
        "figures": [_figure(one) for one in found.figures],
        "zones": found.zones and dict(zip(SIDES, found.zones, strict=True)),
        "third_octaves": [_band(index, *sides) for index, sides in found.bands.items()],
        "density": {
            "freq_Hz": _list(freq_Hz),
            **{
                side: _list(motion.per_si**2 * density)
                for side, density in zip(SIDES, densities, strict=True)
            },
        },
        "transmissibility": found.answer and _answer(found.answer, band_Hz),
        "doubts": found.doubts,
    }


def _samples(side: Side) -> dict[str, Any]:
    return {
        "start_s": rounded(side.start_s), "rate_Hz": rounded(side.rate_Hz),
        "count": len(side.values),
    }  # fmt: skip


def _ratio(found: Ratio | None) -> dict[str, Any]:
    """The interval of after / before."""
    low, high = (found.low, found.high) if found else (np.nan, np.nan)
    return {"low": rounded(low), "high": rounded(high)}


def _figure(figure: Figure) -> dict[str, Any]:
    return {
        "quantity": figure.quantity, "unit": figure.unit, "before": rounded(figure.before),
        "after": rounded(figure.after), "ratio": rounded(figure.change), **_ratio(figure.ratio),
    }  # fmt: skip


def _band(index: int, before: Any, after: Any) -> dict[str, Any]:
    found = ratio(before, after)
    return {
        "nominal_Hz": thirds.nominal_Hz(index), "mid_Hz": rounded(thirds.mid_Hz(index)),
        "before": rounded(before.value), "after": rounded(after.value),
        "ratio": rounded(found.value), **_ratio(found),
    }  # fmt: skip


def _answer(answer: Answer, band_Hz: tuple[float, float]) -> dict[str, Any]:
    found: dict[str, Any] = {"unit": answer.unit, "freq_Hz": _list(answer.responses[0].freq_Hz)}
    for side, one in zip(SIDES, answer.responses, strict=True):
        peak = peak_of(one, band_Hz)
        found[side] = {
            "h1": _list(np.abs(one.h1)), "h2": _list(np.abs(one.h2)), "reach": _list(one.reach),
            "coherence": _list(one.coherence), "averages": rounded(one.averages),
            "chance_coherence": rounded(one.chance_coherence),
            "peak": peak and {"freq_Hz": rounded(peak[0]), "h1": rounded(peak[1])},
        }  # fmt: skip
    return found


def _verdict(verdict: Verdict) -> dict[str, Any]:
    return {
        "channel": verdict.channel, "what": verdict.what, "limit": verdict.limit,
        "value": verdict.value, "passed": verdict.is_kept, "sure": verdict.is_sure,
        "note": verdict.note,
    }  # fmt: skip
