"""Cost of the sensing chain on the emulated Cortex-M4, beside a batch pipeline on CMSIS-DSP.

Exact instruction counts, no cycles: every call of the chain's step is bracketed in its image
(bench/mps2/main_signal_cost.c) and counted by the emulator's plugin. The peer
(bench/mps2/main_cmsis_cost.c) does the same work as one batch of 1024 points in one tick: real FFT,
magnitudes of its bins, RMS; in q15 and in q31.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.bench_exe import Bench, require_emulator
from quiesce.cost_images import built_image
from quiesce.link_map import by_source, read_sections

DEFAULT_RATE_HZ = 1000
OTHER_RATES_HZ = (500, 2000, 4000)
DEFAULT_TICKS = 1_000_000
OTHER_TICKS = 200_000
PROFILE_TICKS = 100_000
RMS_WINDOW_MS = 4000

# The peer computes a spectrum so many times a second, each in one tick.
PEER_UPDATES_HZ = 20
PEER_POINTS = 1024
# Both in the order of their numbers in the image.
PEER_FORMATS = ("q15", "q31")
PEER_PARTS = ("fft", "magnitude", "rms")

RATIO_GOAL = 25
WORST_OVER_MEDIAN_GOAL = 2
MEAN_GOAL_INSTR = 1500
RAM_GOAL_BYTES = 12288


@dataclass(frozen=True)
class Coverage:
    """What the stimulus did to the chain: the same input through the whole controller."""

    valid_ticks: int  # ticks with a valid frequency
    lock_losses: int  # times that it ceased to be valid
    three_peak_ticks: int  # ticks with three components tracked
    bad_samples: int  # refused by conditioning
    fault_kinds: tuple[int, ...]  # numbers of the faults that occurred (quiesce_fault_t)
    differing_ticks: int  # RMS not equal to the controller's: always 0


@dataclass(frozen=True)
class TickCost:
    """One run of the chain: instructions a tick, memory."""

    tick_rate_Hz: int
    ticks: int
    worst_instr: int
    median_instr: int
    mean_instr: float
    ram_bytes: int  # the chain's state
    stack_bytes: int  # deepest use by a step
    coverage: Coverage


@dataclass(frozen=True)
class PeerCost:
    """One batch on CMSIS-DSP: instructions of its parts."""

    number_format: str  # "q15" or "q31"
    fft_instr: int
    magnitude_instr: int
    rms_instr: int
    peak_bin: int  # the highest bin that it found; the input has it at expected_bin
    expected_bin: int
    rms: int  # of its input, in the format's own counts, and the exact one, rounded down
    expected_rms: int

    @property
    def peak_instr(self) -> int:
        """Of the tick that has the batch."""
        return self.fft_instr + self.magnitude_instr + self.rms_instr

    def mean_instr(self, tick_rate_Hz: int) -> float:
        """Per tick, at PEER_UPDATES_HZ batches a second and nothing in between."""
        return self.peak_instr * PEER_UPDATES_HZ / tick_rate_Hz


@dataclass(frozen=True)
class CostFigure:
    name: str
    value: float
    unit: str
    goal: float | None  # None: reported only
    better: str  # "lower" or "higher"

    @property
    def is_ok(self) -> bool | None:
        """Whether the goal is met; None where there is none."""
        if self.goal is None:
            return None
        return self.value <= self.goal if self.better == "lower" else self.value >= self.goal


@dataclass(frozen=True)
class SignalCost:
    ticks: tuple[TickCost, ...]  # one a tick rate; the default rate first
    peers: tuple[PeerCost, ...]  # q15, q31
    modules: dict[str, float]  # mean instructions a tick by source file, the costliest first

    @property
    def default(self) -> TickCost:
        return self.ticks[0]

    def peer(self, number_format: str) -> PeerCost:
        return next(p for p in self.peers if p.number_format == number_format)

    def figures(self) -> list[CostFigure]:
        """The figures of `quiesce bench signal`, in the order of its table."""
        mine = self.default
        worst_goal = WORST_OVER_MEDIAN_GOAL * mine.median_instr
        figures = [
            CostFigure("tick_worst_instr", mine.worst_instr, "instr", worst_goal, "lower"),
            CostFigure("tick_median_instr", mine.median_instr, "instr", None, "lower"),
            CostFigure("tick_mean_instr", mine.mean_instr, "instr", MEAN_GOAL_INSTR, "lower"),
        ]
        for peer in self.peers:
            name = f"cmsis_{peer.number_format}_peak_instr"
            figures.append(CostFigure(name, peer.peak_instr, "instr", None, "lower"))
        for peer in self.peers:
            ratio = peer.peak_instr / mine.worst_instr
            name = f"peak_ratio_{peer.number_format}"
            figures.append(CostFigure(name, ratio, "1", RATIO_GOAL, "higher"))
        figures.append(CostFigure("ram_bytes", mine.ram_bytes, "byte", RAM_GOAL_BYTES, "lower"))
        return figures


def measure_cost(
    ticks: int = DEFAULT_TICKS,
    other_ticks: int = OTHER_TICKS,
    profile_ticks: int = PROFILE_TICKS,
    done: Callable[[str], None] = lambda text: None,
) -> SignalCost:
    """Runs the images and counts; the first call fetches and builds the peer.

    ticks: at the default rate; other_ticks: at each of the other rates; profile_ticks: for the
    share of each source file. done: called with a line after each run. UsageError where a tool,
    the network or an image is missing.
    """
    require_emulator()
    bench = Bench()
    chain = built_image("signal_cost")
    peer_image = built_image("cmsis_cost")
    costs = []
    for rate_Hz in (DEFAULT_RATE_HZ, *OTHER_RATES_HZ):
        count = ticks if rate_Hz == DEFAULT_RATE_HZ else other_ticks
        costs.append(measure_ticks(bench, chain, rate_Hz, count))
        done(f"signal chain: {count} ticks at {rate_Hz} Hz")
    modules = measure_modules(bench, chain, profile_ticks)
    done(f"signal chain: share of each source file, {profile_ticks} ticks")
    peers = []
    for number_format in PEER_FORMATS:
        peers.append(measure_peer(bench, peer_image, number_format))
        done(f"peer: CMSIS-DSP, {number_format}")
    return SignalCost(ticks=tuple(costs), peers=tuple(peers), modules=modules)


def count(bench: Bench, image: Path, *words: int, profile: bool = False) -> dict[str, Any]:
    """Runs an image with these words to its end; what it counted and printed."""
    options = [text for word in words for text in ("--word", str(word))]
    if profile:
        options += ["--profile", "on"]
    return bench.json("count", "--image", str(image), *options)


def measure_ticks(bench: Bench, image: Path, tick_rate_Hz: int, ticks: int) -> TickCost:
    found = count(bench, image, ticks, tick_rate_Hz, RMS_WINDOW_MS, 1)
    printed = found["printed"]
    return TickCost(
        tick_rate_Hz=tick_rate_Hz,
        ticks=found["passes"],
        worst_instr=found["worst"],
        median_instr=found["median"],
        mean_instr=found["mean"],
        ram_bytes=printed["ram_bytes"],
        stack_bytes=printed["stack_bytes"],
        coverage=Coverage(
            valid_ticks=printed["valid_ticks"],
            lock_losses=printed["lock_losses"],
            three_peak_ticks=printed["three_peak_ticks"],
            bad_samples=printed["bad_samples"],
            fault_kinds=tuple(i for i in range(32) if printed["fault_kinds"] >> i & 1),
            differing_ticks=printed["differing_ticks"],
        ),
    )


def measure_modules(bench: Bench, image: Path, ticks: int) -> dict[str, float]:
    found = count(bench, image, ticks, DEFAULT_RATE_HZ, RMS_WINDOW_MS, 0, profile=True)
    executed = {int(address): number for address, number in found["profile"].items()}
    sums = by_source(read_sections(image.with_name(f"{image.name}.map")), executed)
    return {source: number / found["passes"] for source, number in sums.items()}


def measure_peer(bench: Bench, image: Path, number_format: str) -> PeerCost:
    form = PEER_FORMATS.index(number_format)
    parts = [count(bench, image, form, part) for part in range(len(PEER_PARTS))]
    printed = parts[0]["printed"]
    fft, magnitude, rms = (part["worst"] for part in parts)
    return PeerCost(
        number_format=number_format,
        fft_instr=fft,
        magnitude_instr=magnitude,
        rms_instr=rms,
        peak_bin=printed["peak_bin"],
        expected_bin=printed["expected_bin"],
        rms=printed["rms"],
        expected_rms=printed["expected_rms"],
    )


def markdown(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---", *("---:" for _ in head[1:])], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def cost_table_markdown(cost: SignalCost) -> str:
    """The section "Cost" of docs/signal_chain.md: three tables."""
    rows = [
        [
            f"{tick.tick_rate_Hz} Hz",
            f"{tick.ticks:,}",
            f"{tick.worst_instr:,}",
            f"{tick.median_instr:,}",
            f"{tick.mean_instr:,.0f}",
            f"{tick.ram_bytes:,}",
            f"{tick.stack_bytes:,}",
        ]
        for tick in cost.ticks
    ]
    ours = markdown(
        ["tick rate", "ticks", "worst", "median", "mean", "RAM, bytes", "stack, bytes"], rows
    )
    worst = cost.default.worst_instr
    rate_Hz = cost.default.tick_rate_Hz
    peers = markdown(
        [
            f"CMSIS-DSP, {PEER_POINTS} points in one tick",
            "FFT",
            "magnitudes",
            "RMS",
            "peak tick",
            "over our worst tick",
            f"mean a tick ({PEER_UPDATES_HZ} batches a second)",
        ],
        [
            [
                peer.number_format,
                f"{peer.fft_instr:,}",
                f"{peer.magnitude_instr:,}",
                f"{peer.rms_instr:,}",
                f"{peer.peak_instr:,}",
                f"{peer.peak_instr / worst:.1f}",
                f"{peer.mean_instr(rate_Hz):,.0f}",
            ]
            for peer in cost.peers
        ],
    )
    modules = markdown(
        [f"source file, {rate_Hz} Hz", "mean a tick"],
        [[source, f"{mean:,.1f}"] for source, mean in cost.modules.items()],
    )
    return f"{ours}\n\n{peers}\n\n{modules}\n"
