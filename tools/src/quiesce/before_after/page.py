"""The page of a report: the answer first, then tables and plots, then where they come from."""

from typing import Any

from quiesce.before_after import plots
from quiesce.before_after.figures import Found
from quiesce.before_after.pairs import SIDES
from quiesce.before_after.run import Report
from quiesce.before_after.words import HEAD, headline, number, rows
from quiesce.compare.zones import SOURCE
from quiesce.report.page import render

Table = tuple[tuple[str, ...], list[tuple[str, ...]]]


def page(report: Report) -> str:
    band_Hz = report.settings.band_Hz
    return render(
        "before_after/page.html.j2",
        report=report,
        names=[source.file.name for source in report.sources],
        band=band_text(report),
        headlines=[headline(one) for one in report.channels],
        cards=cards(report),
        verdicts=verdicts(report),
        channels=[_channel(one, band_Hz) for one in report.channels],
        reference=report.reference.name if report.reference else "",
        files=files(report),
        sampling=sampling(report),
        changed=changed(report),
        machine=report.settings.machine,
        zone_source=SOURCE,
    )


def band_text(report: Report) -> str:
    low_Hz, high_Hz = report.settings.band_Hz
    return f"between {low_Hz:.4g} and {high_Hz:.4g} Hz"


def _channel(found: Found, band_Hz: tuple[float, float]) -> dict[str, Any]:
    segments = found.spectra[0]
    step_Hz = segments.freq_Hz[1] - segments.freq_Hz[0]
    averages = min(one.averages for one in found.spectra)
    return {
        "name": found.pair.name,
        "doubts": found.doubts,
        "table": (HEAD, rows(found)),
        "zones": found.zones,
        "motion": plots.motion_over_time(found.pair, band_Hz),
        "density": plots.density(found, band_Hz),
        "resolution": f"lines every {step_Hz:.3g} Hz, {averages:.0f} averages",
        "thirds": plots.third_octaves(found, band_Hz),
        "transmissibility": plots.transmissibility(found, band_Hz),
        "steadiness": plots.steadiness(found),
    }


def cards(report: Report) -> list[tuple[Any, ...]]:
    """Of each channel the RMS's change; of the limits how many are missed."""
    found = []
    for one in report.channels:
        figure = one.figure(f"{one.pair.motion.name}_rms")
        assert figure is not None
        text = f"RMS of {one.pair.name}: {number(figure.before)} to {number(figure.after)}"
        found.append((f"{100.0 * (figure.change - 1.0):+.0f} %", f"{text} {figure.unit}"))
    if report.verdicts:
        missed = sum(not one.is_kept for one in report.verdicts)
        word = "pass" if report.is_kept else "fail"
        text = f"{missed} of {len(report.verdicts)} limits missed"
        found.append((word, text, not report.is_kept))
    return found


def verdicts(report: Report) -> Table | None:
    if not report.verdicts:
        return None
    lines = [
        (one.channel, one.what, one.limit, one.value, one.word, one.note) for one in report.verdicts
    ]
    return ("channel", "quantity", "limit", "after", "verdict", "note"), lines


def files(report: Report) -> Table:
    """A row a fact, a column a recording."""
    facts = [
        {
            "file": source.file.name,
            "SHA-256": digest,
            "kind": source.origin.kind,
            **source.origin.facts,
        }
        for source, digest in zip(report.sources, report.hashes, strict=True)
    ]
    keys = dict.fromkeys([*facts[0], *facts[1]])
    return ("", *SIDES), [(key, facts[0].get(key, "-"), facts[1].get(key, "-")) for key in keys]


def sampling(report: Report) -> Table:
    pairs = [one.pair for one in report.channels]
    pairs += [report.reference] if report.reference else []
    lines = [
        (pair.name, side, f"{one.rate_Hz:.6g}", f"{one.duration_s:.4g}", f"{one.start_s:.4f}")
        for pair in pairs
        for side, one in zip(SIDES, pair.sides, strict=True)
    ]
    return ("channel", "recording", "samples a second", "seconds", "first at, s"), lines


def changed(report: Report) -> Table | None:
    found = report.changed_parameters
    if not found:
        return None
    lines = [
        (name, *("-" if value is None else str(value) for value in values))
        for name, *values in found
    ]
    return ("parameter", *SIDES), lines
