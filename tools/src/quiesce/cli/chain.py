"""`quiesce chain`: magnitude and phase of the conditioning, computed and measured."""

import argparse
from pathlib import Path

import numpy as np

from quiesce.base.atomic import output_files
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.engine.bench import Bench
from quiesce.engine.params import effective_params
from quiesce.report.plot_style import COLORS, pyplot, svg_of
from quiesce.signal.chain_response import (
    TICK_RATES_Hz,
    alias_rejection_dB,
    dc_removal,
    decibels,
    decimation,
    degrees,
    largest_difference,
)

EPILOG = """examples:
  quiesce chain
  quiesce chain --set dc_cutoff_mHz=50 --out my_sensor

Computed from the coefficients that the firmware uses. The DC removal is also measured: the firmware
on this machine is driven with sines at every tick rate, and the largest difference is printed.
Written: conditioning.md (the table of docs/explanation/signal-chain.md) and conditioning.svg.
"""

TABLE_Hz = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 35.0, 50.0, 75.0, 100.0, 125.0)
MEASURED_Hz = (0.05, 0.2, 1.0, 5.0, 20.0, 125.0)
BAND_Hz = 50.0
BOTH_RATE_Hz = 1000


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "chain",
        description="Magnitude and phase of the DC removal and of the anti-alias decimation\n"
        "against frequency: table and plot.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="parameter; dc_cutoff_mHz is the one that counts here",
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help=f"folder to write to ({results_text('chain')})"
    )
    parser.set_defaults(run=run)


def shown_dB(value: float) -> str:
    """Three decimals; a gain that rounds to nothing is 0."""
    return f"{value:.3f}".replace("-0.000", "0.000")


def markdown_rows(cutoff_mHz: int) -> list[str]:
    freq_Hz = np.array(TABLE_Hz)
    removal = dc_removal(freq_Hz, cutoff_mHz, BOTH_RATE_Hz)
    columns = [decibels(np.abs(removal)), degrees(removal)]
    for rate_Hz in TICK_RATES_Hz:
        amplitude, delay_s = decimation(freq_Hz, rate_Hz)
        columns += [decibels(amplitude), -360.0 * freq_Hz * delay_s]
    both = 2 + 2 * TICK_RATES_Hz.index(BOTH_RATE_Hz)
    columns += [columns[0] + columns[both], columns[1] + columns[both + 1]]
    rows = []
    for i, freq in enumerate(freq_Hz):
        pairs = zip(columns[::2], columns[1::2], strict=True)
        cells = [f"{shown_dB(gain[i])} / {phase[i]:.2f}" for gain, phase in pairs]
        rows.append(f"| {freq:g} | " + " | ".join(cells) + " |")
    return rows


def markdown(cutoff_mHz: int) -> str:
    """The table of docs/explanation/signal-chain.md: decibel / degree."""
    rates = [f"decimation at {rate_Hz} Hz" for rate_Hz in TICK_RATES_Hz]
    heads = ["f (Hz)", f"DC removal, {cutoff_mHz / 1000:g} Hz", *rates, f"both, {BOTH_RATE_Hz} Hz"]
    facts = []
    for rate_Hz in TICK_RATES_Hz:
        _, delay_s = decimation(np.array([1.0]), rate_Hz)
        facts.append(
            f"| {rate_Hz} Hz | {delay_s * 1e3:g} ms | "
            f"{ripple_dB(rate_Hz):.4f} dB | {alias_rejection_dB(rate_Hz, BAND_Hz):.1f} dB |"
        )
    return "\n".join(
        [
            "| " + " | ".join(heads) + " |",
            "|" + "---|" * len(heads),
            *markdown_rows(cutoff_mHz),
            "",
            f"| tick rate | delay | largest gain error, 0 .. {BAND_Hz:g} Hz | "
            f"least attenuation of what folds into 0 .. {BAND_Hz:g} Hz |",
            "|---|---|---|---|",
            *facts,
            "",
        ]
    )


def ripple_dB(rate_Hz: int) -> float:
    amplitude, _ = decimation(np.arange(0.0, BAND_Hz + 0.05, 0.1), rate_Hz)
    return float(np.abs(decibels(amplitude)).max())


def figure_svg(cutoff_mHz: int) -> str:
    plt = pyplot()
    figure, (gains, phases) = plt.subplots(2, 1, sharex=True, figsize=(8, 6))
    freq_Hz = np.geomspace(TABLE_Hz[0], TABLE_Hz[-1], 600)
    removal = dc_removal(freq_Hz, cutoff_mHz, BOTH_RATE_Hz)
    gains.semilogx(freq_Hz, decibels(np.abs(removal)), color=COLORS["main"], label="DC removal")
    phases.semilogx(freq_Hz, degrees(removal), color=COLORS["main"])
    shades = np.linspace(0.35, 1.0, len(TICK_RATES_Hz))
    for rate_Hz, alpha in zip(TICK_RATES_Hz, shades, strict=True):
        amplitude, delay_s = decimation(freq_Hz, rate_Hz)
        look = {"color": COLORS["current"], "alpha": alpha}
        gains.semilogx(freq_Hz, decibels(amplitude), label=f"decimation at {rate_Hz} Hz", **look)
        phases.semilogx(freq_Hz, -360.0 * freq_Hz * delay_s, **look)
        if rate_Hz == BOTH_RATE_Hz:
            both = {"color": COLORS["bound"], "linestyle": "--", "linewidth": 1.0}
            gains.semilogx(
                freq_Hz,
                decibels(np.abs(removal) * amplitude),
                label=f"both at {rate_Hz} Hz",
                **both,
            )
            phases.semilogx(freq_Hz, degrees(removal) - 360.0 * freq_Hz * delay_s, **both)
    gains.set_ylabel("magnitude (dB)")
    gains.set_ylim(-14.0, 1.0)
    gains.legend(loc="lower center")
    phases.set_ylabel("phase (degree)")
    phases.set_xlabel("frequency (Hz)")
    phases.set_xlim(freq_Hz[0], freq_Hz[-1])
    return svg_of(figure)


def run(args: argparse.Namespace) -> int:
    bench = Bench()
    cutoff_mHz = effective_params(bench, args.set)["dc_cutoff_mHz"]
    worst_dB, worst_deg = largest_difference(bench, MEASURED_Hz, cutoff_mHz)
    table = markdown(cutoff_mHz)
    out = args.out or results_folder() / "chain"
    with output_files(out) as staging:
        (staging / "conditioning.md").write_text(table, encoding="utf-8")
        (staging / "conditioning.svg").write_text(figure_svg(cutoff_mHz), encoding="utf-8")
    print(table)
    print(
        f"measured  DC removal through the firmware, {len(MEASURED_Hz)} sines at each of "
        f"{len(TICK_RATES_Hz)} tick rates: within {worst_dB:.1e} dB and {worst_deg:.1e} degree"
    )
    print(f"written   {shown(out / 'conditioning.md')}, {shown(out / 'conditioning.svg')}")
    return 0
