"""The plots of `./tools/benchmark signal`."""

from pathlib import Path
from typing import Any

import numpy as np
from quiesce.report.plot_style import COLORS, pyplot, svg_of

from quiesce_benchmarks.signal.accuracy import EXCESS_FACTOR, GROUPS, Group, SNRS_dB, rms
from quiesce_benchmarks.signal.response import SETTLED_SHARE, Step
from quiesce_benchmarks.signal.truth import Answers

GROUP_COLORS = ("main", "current", "constant_best", "fuzzy_selftune_printed")
SHOWN_BEFORE_s = 0.1


def write(folder: Path, name: str, figure: Any) -> None:
    (folder / name).write_text(svg_of(figure), encoding="utf-8")


def by_name(groups: list[Group], name: str) -> list[Group]:
    return sorted((g for g in groups if g.name == name), key=lambda g: g.snr_dB)


def plot_accuracy(folder: Path, groups: list[Group]) -> None:
    """RMS error against SNR beside the bound: frequency, its ratio, phase."""
    figure, axes = pyplot().subplots(1, 3, figsize=(12, 3.8))
    for (name, _), color in zip(GROUPS.items(), GROUP_COLORS, strict=True):
        some = by_name(groups, name)
        snr_dB = [g.snr_dB for g in some]
        label = "2.1 .. 48 Hz" if name == "band" else name
        style = {"color": COLORS[color], "marker": "o", "markersize": 3.5, "label": label}
        axes[0].semilogy(snr_dB, [rms(g.readings.error_Hz) for g in some], **style)
        axes[1].semilogy(snr_dB, [g.readings.ratio for g in some], **style)
        axes[2].semilogy(snr_dB, [rms(g.readings.phase_error_deg) for g in some], **style)
    band = by_name(groups, "band")
    bound = {"color": COLORS["bound"], "linestyle": "--", "label": "Cramer-Rao bound"}
    axes[0].semilogy(SNRS_dB, [rms(g.readings.bound_Hz) for g in band], **bound)
    axes[1].axhline(1.0, **bound)
    goals = [1.5 if snr_dB <= 40 else 2.0 for snr_dB in SNRS_dB[1:]]
    axes[1].step(SNRS_dB[1:], goals, where="pre", color=COLORS["muted"], label="goal")
    phase_bound = np.array([rms(g.readings.phase_bound_deg) for g in band])
    axes[2].semilogy(SNRS_dB, phase_bound, **bound)
    goal_deg = EXCESS_FACTOR * phase_bound + 0.5
    axes[2].semilogy(SNRS_dB, goal_deg, color=COLORS["muted"], label="goal")
    axes[0].set(title="Frequency", ylabel="RMS error (Hz)", xlabel="SNR (dB)")
    axes[1].set(title="Frequency over its bound", ylabel="RMS error / bound", xlabel="SNR (dB)")
    axes[2].set(title="Phase at the current tick", ylabel="RMS error (deg)", xlabel="SNR (dB)")
    for one in axes:
        one.legend()
    write(folder, "accuracy.svg", figure)


def plot_steps(folder: Path, steps: list[Step]) -> None:
    """Frequency of all trials, and the share of them that is valid, around the step."""
    figure, axes = pyplot().subplots(
        2, len(steps), figsize=(12, 4.6), sharex=True, height_ratios=[3, 1], squeeze=False
    )
    for column, step in enumerate(steps):
        freq_Hz, is_valid = step.traces["freq_Hz"], step.traces["is_valid"]
        time_s = np.arange(freq_Hz.shape[1]) / step.rate_Hz - SHOWN_BEFORE_s
        top, bottom = axes[:, column]
        low, middle, high = np.quantile(freq_Hz, [0.0, 0.5, 1.0], axis=0)
        near = SETTLED_SHARE * step.to_Hz
        top.axhspan(step.to_Hz - near, step.to_Hz + near, color=COLORS["shade"], label="5 %")
        top.fill_between(time_s, low, high, color=COLORS["main"], alpha=0.25, label="all trials")
        top.plot(time_s, middle, color=COLORS["main"], label="median")
        top.axvline(step.settle_s.max(), color=COLORS["current"], label="worst settling")
        top.set(title=f"{step.from_Hz:g} to {step.to_Hz:g} Hz")
        top.set_ylim(0.0, 1.5 * max(step.from_Hz, step.to_Hz))
        bottom.plot(time_s, 100.0 * is_valid.mean(axis=0), color=COLORS["main"])
        bottom.set(xlabel="time after the step (s)", ylim=(-5, 105))
    axes[0, 0].set_ylabel("frequency (Hz)")
    axes[1, 0].set_ylabel("valid (%)")
    axes[0, 0].legend()
    write(folder, "step_response.svg", figure)


def plot_truth(folder: Path, answers: list[Answers]) -> None:
    """Every case: the frequency to be reported, and how much stronger the other component is."""
    plt = pyplot()
    figure, axes = plt.subplots(1, len(answers), figsize=(12, 3.8), squeeze=False)
    for one, answer in zip(axes[0], answers, strict=True):
        freq_Hz, amplitude, is_correct = (
            answer.cases.freq_Hz[:, 0],
            answer.cases.amplitude_m_s2,
            answer.is_correct,
        )
        ratio = amplitude[:, 1] / amplitude[:, 0]
        for chosen, color, marker, label in (
            (is_correct, "main", "o", "right"),
            (~is_correct, "current", "x", "not right at every tick"),
        ):
            style = {"color": COLORS[color], "marker": marker, "markersize": 4, "linestyle": ""}
            label = f"{label}: {int(chosen.sum())}"
            one.loglog(freq_Hz[chosen], ratio[chosen], **style, label=label)
        one.set(title=answer.kind, xlabel="to be reported (Hz)")
        one.set_xticks([2, 5, 10, 20, 50], ["2", "5", "10", "20", "50"], minor=False)
        one.xaxis.set_minor_formatter(plt.NullFormatter())
        one.legend()
    axes[0, 0].set_ylabel("acceleration of the other over it")
    write(folder, "truth_table.svg", figure)
