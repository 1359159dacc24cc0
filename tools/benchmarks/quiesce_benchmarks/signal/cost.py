"""Cost of the sensing chain on the emulated Cortex-M4, beside a batch pipeline on CMSIS-DSP.

Exact instruction counts, no cycles: every call of the chain's step is bracketed in its image
(tools/benchmarks/mps2/main_signal_cost.c) and counted by the emulator's plugin. The peer
(tools/benchmarks/mps2/main_cmsis_cost.c) does the same work as one batch of 1024 points in one
tick: real FFT, magnitudes of its bins, RMS; in q15 and in q31.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.table import format_table
from quiesce.engine.bench import Bench, require_emulator

from quiesce_benchmarks.images import built_image, count
from quiesce_benchmarks.link_map import by_source, read_sections
from quiesce_benchmarks.report import Figure

DEFAULT_RATE_HZ = 1000
OTHER_RATES_HZ = (500, 2000, 4000)
DEFAULT_TICKS = 1_000_000
PROFILE_TICKS = 100_000
RMS_WINDOW_MS = 4000

# The peer computes a spectrum so many times a second, each in one tick.
PEER_UPDATES_HZ = 20
PEER_POINTS = 1024
# Both in the order of their numbers in the image.
PEER_FORMATS = ("q15", "q31")
PEER_PARTS = ("fft", "magnitude", "rms")

COST_RUNS = 1 + len(OTHER_RATES_HZ) + 2

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
    worst_tick: int  # the first with that many, from 1
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
class SignalCost:
    ticks: tuple[TickCost, ...]  # one a tick rate; the default rate first
    peers: tuple[PeerCost, ...]  # q15, q31; none where the peer cannot be had
    modules: dict[str, float]  # mean instructions a tick by source file, the costliest first
    worst_modules: dict[str, int]  # of the worst tick at the default rate
    absent: tuple[str, ...] = ()  # why there is no peer, one line

    @property
    def default(self) -> TickCost:
        return self.ticks[0]

    def figures(self) -> list[Figure]:
        """The figures of `./tools/benchmark signal`, in the order of its table."""
        mine = self.default
        peaks = {peer.number_format: peer.peak_instr for peer in self.peers}
        return [
            Figure(
                "tick_worst_instr",
                mine.worst_instr,
                "instr",
                WORST_OVER_MEDIAN_GOAL * mine.median_instr,
                "lower",
            ),
            Figure("tick_median_instr", mine.median_instr, "instr", None, "lower"),
            Figure("tick_mean_instr", mine.mean_instr, "instr", MEAN_GOAL_INSTR, "lower"),
            *(
                Figure(f"cmsis_{form}_peak_instr", peaks.get(form), "instr", None, "lower")
                for form in PEER_FORMATS
            ),
            *(
                Figure(
                    f"peak_ratio_{form}",
                    peaks[form] / mine.worst_instr if form in peaks else None,
                    "1",
                    RATIO_GOAL,
                    "higher",
                )
                for form in PEER_FORMATS
            ),
            Figure("ram_bytes", mine.ram_bytes, "byte", RAM_GOAL_BYTES, "lower"),
        ]

    def context(self) -> dict[str, Any]:
        """Everything, as values of JSON."""
        return {
            "ticks": [asdict(tick) for tick in self.ticks],
            "peers": [
                {
                    **asdict(peer),
                    "peak_instr": peer.peak_instr,
                    "mean_instr": peer.mean_instr(self.default.tick_rate_Hz),
                }
                for peer in self.peers
            ],
            "modules_mean_instr": self.modules,
            "modules_worst_instr": self.worst_modules,
            "rms_window_ms": RMS_WINDOW_MS,
        }


def measure_cost(
    bench: Bench | None = None,
    ticks: int = DEFAULT_TICKS,
    profile_ticks: int = PROFILE_TICKS,
    done: Callable[[str], None] = lambda text: None,
) -> SignalCost:
    """Runs the images and counts; the first call builds them and fetches the peer.

    ticks: at each rate; profile_ticks: for the share of each source file. done: called with a line
    after each of COST_RUNS runs. UsageError where the emulator or the chain's image is missing;
    where only the peer is (no network), the result has none and says why.
    """
    require_emulator()
    bench = bench or Bench()
    chain = built_image("signal_cost")
    costs = []
    for rate_Hz in (DEFAULT_RATE_HZ, *OTHER_RATES_HZ):
        costs.append(measure_ticks(bench, chain, rate_Hz, ticks))
        done(f"cost of the signal chain: {ticks} ticks at {rate_Hz} Hz")
    modules = measure_modules(bench, chain, profile_ticks)
    worst_modules = measure_worst_modules(bench, chain, costs[0].worst_tick)
    done(f"cost of each source file: {profile_ticks} ticks, and the worst")
    absent: tuple[str, ...] = ()
    peers: tuple[PeerCost, ...] = ()
    try:
        image = built_image("cmsis_cost")
    except UsageError as error:
        absent = (f"peer CMSIS-DSP: {one_line(error)}",)
    else:
        peers = tuple(measure_peer(bench, image, form) for form in PEER_FORMATS)
    done("cost of the peer, CMSIS-DSP")
    return SignalCost(tuple(costs), peers, modules, worst_modules, absent)


def measure_ticks(
    bench: Bench, image: Path, tick_rate_Hz: int, ticks: int, estimator: int = 0
) -> TickCost:
    """estimator: value of the parameter."""
    found = count(bench, image, ticks, tick_rate_Hz, RMS_WINDOW_MS, 1, estimator)
    printed = found["printed"]
    return TickCost(
        tick_rate_Hz=tick_rate_Hz,
        ticks=found["passes"],
        worst_instr=found["worst"],
        worst_tick=found["worst_pass"],
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


def profile(bench: Bench, image: Path, ticks: int, which: str) -> dict[str, int]:
    """Instructions by source file, in all ticks or in the one of that number."""
    found = count(bench, image, ticks, DEFAULT_RATE_HZ, RMS_WINDOW_MS, 0, profile=which)
    executed = {int(address): number for address, number in found["profile"].items()}
    return by_source(read_sections(image.with_name(f"{image.name}.map")), executed)


def measure_modules(bench: Bench, image: Path, ticks: int) -> dict[str, float]:
    sums = profile(bench, image, ticks, "all")
    return {source: number / ticks for source, number in sums.items()}


def measure_worst_modules(bench: Bench, image: Path, worst_tick: int) -> dict[str, int]:
    """The run is the same up to that tick, which is its last."""
    return profile(bench, image, worst_tick, str(worst_tick))


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


def tick_rows(cost: SignalCost) -> list[list[str]]:
    return [
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


def peer_rows(cost: SignalCost) -> list[list[str]]:
    return [
        [
            peer.number_format,
            f"{peer.fft_instr:,}",
            f"{peer.magnitude_instr:,}",
            f"{peer.rms_instr:,}",
            f"{peer.peak_instr:,}",
            f"{peer.peak_instr / cost.default.worst_instr:.1f}",
            f"{peer.mean_instr(cost.default.tick_rate_Hz):,.0f}",
        ]
        for peer in cost.peers
    ]


Table = tuple[list[str], list[list[str]]]


def tables(cost: SignalCost) -> list[Table]:
    """Heads and rows: tick rates, peers (where there are any), source files."""
    rate_Hz = cost.default.tick_rate_Hz
    ticks = ["tick rate", "ticks", "worst", "median", "mean", "RAM, bytes", "stack, bytes"]
    peers = [
        f"CMSIS-DSP, {PEER_POINTS} points",
        "FFT",
        "magnitudes",
        "RMS",
        "peak tick",
        "over our worst",
        f"mean a tick at {PEER_UPDATES_HZ} a second",
    ]
    sources = [f"source file, {rate_Hz} Hz", "mean a tick", "in the worst tick"]
    source_rows = [
        [source, f"{cost.modules.get(source, 0):,.1f}", f"{cost.worst_modules.get(source, 0):,}"]
        for source in {**cost.modules, **cost.worst_modules}
    ]
    found = [(ticks, tick_rows(cost)), (peers, peer_rows(cost)), (sources, source_rows)]
    return [(head, rows) for head, rows in found if rows]


def cost_tables(cost: SignalCost) -> list[str]:
    """For the terminal."""
    return [format_table(head, rows) for head, rows in tables(cost)]


def cost_table_markdown(cost: SignalCost) -> str:
    """The same for the section "Cost" of docs/explanation/signal-chain.md."""
    return "\n\n".join(markdown(head, rows) for head, rows in tables(cost)) + "\n"
