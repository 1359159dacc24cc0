"""The tables that `./tools/benchmark signal` prints below its figures, from its context."""

from collections.abc import Sequence
from typing import Any

from quiesce.base.table import format_table

from quiesce_benchmarks.report import number_text


def cell(value: Any) -> str:
    return value if isinstance(value, str) else number_text(value)


def table(title: str, rows: Sequence[dict[str, Any]], columns: dict[str, str]) -> str:
    """columns: headings by key."""
    body = [[cell(row[key]) for key in columns] for row in rows]
    return f"{title}\n{format_table(list(columns.values()), body)}"


def accuracy_table(rows: Sequence[dict[str, Any]]) -> str:
    return table(
        "accuracy: RMS errors; the bound is Cramer and Rao's over the window in use",
        rows,
        {
            "snr_dB": "SNR dB",
            "group": "tones",
            "rmse_over_bound": "freq over bound",
            "rmse_Hz": "freq Hz",
            "phase_rms_deg": "phase deg",
            "phase_bound_deg": "bound deg",
            "outlier_pct": "10 % off, %",
            "invalid_pct": "invalid %",
            "window_ms": "window ms",
        },
    )


def step_table(rows: Sequence[dict[str, Any]]) -> str:
    return table(
        "steps at 20 dB",
        rows,
        {
            "step": "step",
            "settle_worst_s": "settled s, worst",
            "settle_median_s": "median",
            "invalid_after_worst_ms": "invalid ms, worst",
            "invalid_after_median_ms": "median",
            "valid_again_worst_s": "valid again s, worst",
            "valid_again_median_s": "median",
        },
    )


def plant_table(rows: Sequence[dict[str, Any]]) -> str:
    return table(
        "steps of the frozen plant's drive, beside least squares over windows of equal length",
        rows,
        {
            "step": "step",
            "current_A": "A",
            "settle_s": "settled s",
            "offline_settle_s": "least squares s",
            "invalid_after_ms": "invalid ms",
            "valid_pct": "valid %",
            "rms_apart_Hz": "apart Hz",
        },
    )


def stress_table(rows: Sequence[dict[str, Any]]) -> str:
    return table(
        "what sensors do",
        rows,
        {
            "kind": "event",
            "valid_after_pct": "valid after %",
            "valid_but_wrong_pct": "valid but wrong %",
            "valid_without_tone_pct": "without a tone %",
            "right_again_worst_s": "right again s, worst",
            "right_again_median_s": "median",
            "bad_samples": "bad samples",
        },
    )


def recording_table(rows: Sequence[dict[str, Any]]) -> str:
    flat = [
        {
            **row,
            "within": (row["reference"] or {}).get("within_0p12Hz_pct"),
            "offline_within": row["offline"]["within_2pct_pct"],
            "offline_error": row["offline"]["median_error_Hz"],
            "any": row["offline"]["within_2pct_valid_or_not_pct"],
        }
        for row in rows
    ]
    return table(
        "recordings: reference sensor within 0.12 Hz, least squares within 2 %",
        flat,
        {
            "file": "file",
            "valid_pct": "valid %",
            "median_freq_Hz": "median Hz",
            "within": "reference %",
            "offline_within": "least squares %",
            "offline_error": "median apart Hz",
            "any": "valid or not %",
        },
    )


def tables(context: dict[str, Any]) -> list[str]:
    out = [
        accuracy_table(context["accuracy"]),
        step_table(context["steps"]),
        plant_table(context["plant_steps"]),
        stress_table(context["stress"]),
    ]
    if context["recordings"]:
        out.append(recording_table(context["recordings"]))
    return out
