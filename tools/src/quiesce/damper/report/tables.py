"""What an identification found, as tables: for the terminal, the page and programs."""

import math
import tomllib
from collections.abc import Sequence
from typing import Any

import numpy as np

from quiesce.base.table import format_table
from quiesce.damper.data.folds import AMPLITUDE, CURRENT, LEAVES_OUT, MOTION, QUARTERS, STANDS_FOR
from quiesce.damper.data.split import Segment, levels_of
from quiesce.damper.fit.intervals import Interval, Whiteness
from quiesce.damper.fitted import BLACK_BOX, PARAMETRIC, Fitted
from quiesce.damper.plain import plain
from quiesce.damper.ranking import best, ranked, sureness
from quiesce.damper.report.runs import shortened
from quiesce.damper.score import Score, SegmentScore
from quiesce.damper.validation import DRAWS, errors_by_kind

Table = tuple[list[str], list[list[str]]]

# A parameter whose 95 % interval is wider than this part of it is hardly known.
WEAK_PART = 0.5
# A band that is this wide and wider at a tenth of the force, as a part, is the same everywhere.
_FLAT_BAND = 0.95
HEADS = {
    CURRENT: "new current %",
    MOTION: "new motion %",
    AMPLITUDE: "new amplitude %",
    QUARTERS: "new rows %",
}


def percent(value: float | None) -> str:
    """An error as a percentage; a model that diverges has none."""
    if value is None or math.isnan(value):
        return "-"
    return f"{100.0 * value:.2f}" if math.isfinite(value) else "diverges"


def winners(fitted: Sequence[Fitted]) -> dict[str, Fitted]:
    """The best of all and of each category that there is."""
    order = ranked(fitted)
    return {"best": order[0], **best(fitted)} if order else {}


def ranking_table(fitted: Sequence[Fitted]) -> Table:
    head = ["", "model", "kind", "validation %", "train %", "test %", "numbers", "passive", "s", ""]
    rows = [
        [
            str(place),
            one.name,
            one.kind,
            percent(one.validation_error),
            percent(one.train.error),
            percent(one.test.error if one.test else None),
            str(one.parameter_count),
            one.passivity.text,
            f"{one.seconds:.1f}",
            "" if one.is_complete else "cut short",
        ]
        for place, one in enumerate(ranked(fitted), start=1)
    ]
    return head, rows


def validation_table(fitted: Sequence[Fitted]) -> Table:
    """Errors by the kind of new data that they stand for, and in how many of the redrawn
    validations the first model has the smaller error. Empty where nothing was left out."""
    order = ranked(fitted)
    by_kind = [errors_by_kind(one.folds) for one in order]
    kinds = [kind for kind in STANDS_FOR if any(kind in errors for errors in by_kind)]
    if not kinds:
        return [], []
    rows = [
        [
            one.name,
            *(percent(errors.get(kind)) for kind in kinds),
            percent(max((fold.error for fold in one.folds), default=None)),
            percent(one.validation_error),
            "" if sure is None else f"{100.0 * sure:.0f}",
        ]
        for one, errors, sure in zip(order, by_kind, sureness(order), strict=True)
    ]
    heads = [HEADS[kind] for kind in kinds]
    return ["model", *heads, "worst fold %", "validation %", "first before it %"], rows


def validation_lines(fitted: Sequence[Fitted]) -> list[str]:
    """What was left out, for which new data each error stands, and how sure the first place is."""
    first = ranked(fitted)[0]
    left_out: dict[str, list[str]] = {}
    for one in first.folds:
        left_out.setdefault(one.kind, []).append(one.left_out)
    lines = [
        f"{HEADS[kind]}: stands for {STANDS_FOR[kind]}; left out in turn: {', '.join(names)}"
        for kind, names in left_out.items()
    ]
    if set(left_out) == {QUARTERS}:
        lines.append(
            "nothing whole could be left out: for another current, motion or amplitude no error "
            "here stands; record several (quiesce identify plan)"
        )
    sure = sureness(ranked(fitted))
    if len(sure) > 1 and sure[1] is not None:
        lines.append(
            f"{first.name} comes before {ranked(fitted)[1].name} in {100.0 * sure[1]:.0f} % of "
            f"{DRAWS} validations redrawn from the same rows"
        )
    return lines


def band_lines(fitted: Sequence[Fitted]) -> list[str]:
    """The first model's band in words, and which folds it came from."""
    first = ranked(fitted)[0]
    if first.band is None or not math.isfinite(first.band.part):
        return []
    high_N = first.band.scale_N
    widths = first.band.half_width_N(np.array([0.1 * high_N, high_N]))
    without = " and ".join(LEAVES_OUT[kind] for kind in first.band.kinds)
    line = f"95 % of the rows that refits of {first.name} left out ({without}) lie within "
    line += f"{widths[1]:.3g} N of them"
    if widths[0] < _FLAT_BAND * widths[1]:
        line += (
            f" where the force reaches {high_N:.3g} N, within {widths[0]:.3g} N where it reaches "
            f"{0.1 * high_N:.3g} N"
        )
    held = "" if first.coverage is None else f"; of the held-out rows {100 * first.coverage:.0f} %"
    return [line + held]


def winner_table(fitted: Sequence[Fitted]) -> Table:
    names = {"best": "best of all", PARAMETRIC: "best parametric", "passive": "best passive"}
    names[BLACK_BOX] = "best black box"
    rows = [
        [
            names.get(what, what),
            one.name,
            percent(one.validation_error),
            percent(one.test.error if one.test else None),
        ]
        for what, one in winners(fitted).items()
    ]
    return ["", "model", "validation %", "test %"], rows


def status_of(one: Interval) -> str:
    if one.at_bound:
        return "at its bound"
    if not math.isfinite(one.relative) or not math.isfinite(one.high - one.low):
        return "not determined"
    return "hardly known" if one.relative > WEAK_PART else ""


def parameter_table(fitted: Fitted) -> Table:
    rows = [
        [one.name, f"{one.value:.6g}", interval_text(one), one.unit, status_of(one)]
        for one in fitted.intervals
    ]
    return ["parameter", "value", "95 % interval", "unit", ""], rows


def interval_text(one: Interval) -> str:
    if one.at_bound or not math.isfinite(one.high - one.low):
        return ""
    return f"{one.low:.6g} .. {one.high:.6g}"


def segment_table(fitted: Fitted) -> Table:
    """Every test's error, held-out ones marked."""
    scores = [("train", fitted.train)] + ([("test", fitted.test)] if fitted.test else [])
    rows = [
        [
            shortened(one.name),
            part,
            "switched" if one.level is None else f"{one.level:.3g}",
            str(one.samples),
            percent(one.error),
            f"{one.largest_N:.4g}",
        ]
        for part, score in scores
        for one in score.segments
    ]
    return ["test", "part", "command", "rows", "error %", "largest error N"], rows


def whiteness_text(found: Whiteness | None) -> str:
    if found is None:
        return "the model diverges: there is no residual to judge"
    if found.is_white:
        return "the residual is white noise: nothing is left that a model could explain"
    return (
        f"the residual is not white (Ljung-Box {found.statistic:.3g} over {found.lags} lags, white "
        f"below {found.limit:.3g}); it is correlated over about {found.correlation_time:.2g} rows: "
        "structure is left, or the force channel is filtered"
    )


def data_lines(train: Sequence[Segment], test: Sequence[Segment]) -> list[str]:
    lines = []
    for name, segments in (("fitted", train), ("held out", test)):
        if segments:
            lines.append(f"{name}: {extent_text(segments)}")
    return lines if test else [*lines, "held out: nothing (--train and --test state a part)"]


def extent_text(segments: Sequence[Segment]) -> str:
    rows = sum(len(one) for one in segments)
    duration_s = sum(len(one) / one.record.rate_Hz for one in segments)
    unit = segments[0].record.command_unit
    levels = levels_of(segments)
    names = ", ".join(f"{abs(round(level, 2)):g}" for level in levels)
    command = f"{names} {unit}" if levels else f"a switched command in {unit}"
    return f"{len(segments)} test(s), {rows} rows, {duration_s:.4g} s, {command}"


def text_report(
    fitted: Sequence[Fitted],
    train: Sequence[Segment],
    test: Sequence[Segment],
    notes: Sequence[str],
    white: Whiteness | None = None,
    where: Sequence[str] = (),
) -> str:
    """For the terminal. white: of the first model's residual, where it is known; where: in words
    where its error is made."""
    parts = [*(f"- {note}" for note in notes), *data_lines(train, test), ""]
    if not fitted:
        return "\n".join([*parts, "no model was fitted"])
    parts.append("errors are ||F - F_model|| / ||F||, the model running free")
    parts.append(format_table(*ranking_table(fitted), left=(1, 2, 7, 9)))
    head, rows = validation_table(fitted)
    if head:
        parts += ["", format_table(head, rows, left=(0,))]
        parts += [f"- {line}" for line in [*validation_lines(fitted), *band_lines(fitted)]]
    parts += ["", format_table(*winner_table(fitted), left=(0, 1))]
    first = ranked(fitted)[0]
    if first.intervals:
        parts += ["", f"parameters of {first.name} ({first.title})"]
        parts.append(format_table(*parameter_table(first), left=(0, 3, 4)))
    if white is not None:
        parts += ["", whiteness_text(white)]
    parts += [f"- {text}" for text in where]
    remarks = [f"- {one.name}: {note}" for one in ranked(fitted) for note in one.notes]
    return "\n".join([*parts, *(["", *remarks] if remarks else [])])


def json_report(
    fitted: Sequence[Fitted],
    train: Sequence[Segment],
    test: Sequence[Segment],
    notes: Sequence[str],
    context: dict[str, Any],
    white: Whiteness | None = None,
    where: Sequence[str] = (),
) -> dict[str, Any]:
    """Everything, in SI units; what is not finite is null."""
    report = {
        "data": {"notes": list(notes), "train": extents(train), "test": extents(test)},
        "winners": {what: one.name for what, one in winners(fitted).items()},
        "models": [
            {**json_model(one), "share_first_before": sure}
            for one, sure in zip(ranked(fitted), sureness(ranked(fitted)), strict=True)
        ],
        "validation": validation_lines(fitted) if fitted else [],
        "where": list(where),
        "whiteness": whiteness_json(white),
        "context": context,
    }
    return plain(report)


def whiteness_json(white: Whiteness | None) -> dict[str, Any] | None:
    return None if white is None else {**vars(white), "is_white": white.is_white}


def extents(segments: Sequence[Segment]) -> list[dict[str, Any]]:
    return [
        {
            "test": one.record.name,
            "first_row": one.first,
            "end_row": one.end,
            "rate_Hz": one.record.rate_Hz,
            "command": one.record.level,
            "command_unit": one.record.command_unit,
        }
        for one in segments
    ]


def json_model(one: Fitted) -> dict[str, Any]:
    return {
        "name": one.name,
        "title": one.title,
        "kind": one.kind,
        "validation_error": one.validation_error,
        "validation": {
            "by_kind": errors_by_kind(one.folds),
            "folds": [
                {"kind": fold.kind, "left_out": fold.left_out, "error": fold.error}
                for fold in one.folds
            ],
        },
        "band_95": vars(one.band) if one.band else None,
        "coverage": one.coverage,
        "train": json_score(one.train),
        "test": json_score(one.test) if one.test else None,
        "parameter_count": one.parameter_count,
        "passive": one.passivity.text,
        "seconds": one.seconds,
        "is_complete": one.is_complete,
        "intervals": [
            {**vars(interval), "status": status_of(interval)} for interval in one.intervals
        ],
        "notes": list(one.notes),
        "damper": tomllib.loads(one.damper.to_toml()),
    }


def json_score(score: Score) -> dict[str, Any]:
    return {
        "error": score.error,
        "mean_error": score.mean_error,
        "tests": [json_segment(one) for one in score.segments],
    }


def json_segment(one: SegmentScore) -> dict[str, Any]:
    return {
        "test": one.name,
        "command": one.level,
        "rows": one.samples,
        "error": one.error,
        "largest_error_N": one.largest_N,
    }
