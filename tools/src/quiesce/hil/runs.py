"""The closed-loop runs behind `quiesce hil`: which ones, and their results from the bench."""

import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from quiesce.base.progress import Progress
from quiesce.engine.bench import Bench, echo_image, image, setting_options, target_options
from quiesce.engine.laws import CONSTANT_BEST, OPEN_LOOP, Law
from quiesce.engine.params import effective_params
from quiesce.engine.pool import run_all
from quiesce.engine.scenarios import Scenario
from quiesce.engine.trace import Trace, read_trace

OVER_CAN = ("linux", "mps2-uart")  # targets that speak CAN messages
CONSTANT_STEP_mA = 500
QUICK_CONSTANT_STEP_mA = 2500
TRACE_COLUMNS = [
    "t_s", "x5_um", "a5_mm_s2", "coil_A", "freq_uHz", "freq_is_valid", "rms_um_s2",
    "current_cmd_mA",
]  # fmt: skip

Done = TypeVar("Done")


@dataclass(frozen=True)
class Case:
    scenario: Scenario
    law: Law
    target: str


@dataclass(frozen=True)
class Run:
    case: Case
    figures: dict[str, Any]  # the bench's own
    trace: Trace


def displacement_um(figures: dict[str, Any], number: str = "") -> float:
    """Of the first window, or with number "2" of the second: its amplitude, or its RMS where the
    excitation has no one frequency."""
    amplitude = figures[f"amp{number}_um"]
    return figures[f"disp_rms{number}_um"] if amplitude is None else amplitude


def reduction_pct(value: float | None, open_loop: float | None) -> float | None:
    if value is None or not open_loop:
        return None
    return round(100.0 * (1.0 - value / open_loop), 4)


@dataclass(frozen=True)
class ConstantSearch:
    """Figures over a grid of constant currents, and the best of them.

    Best: smallest displacement, as amplitude in a steady scenario and as RMS after a step.
    """

    scenario: Scenario
    current_mA: list[int]
    figures: list[dict[str, Any]]

    def displacement_um(self, index: int) -> float:
        figures = self.figures[index]
        return figures["rms_disp_um"] if self.scenario.is_step else displacement_um(figures)

    @property
    def best_mA(self) -> int:
        return self.current_mA[min(range(len(self.current_mA)), key=self.displacement_um)]


def lacked(scenario: Scenario, law: Law) -> str | None:
    """The first signal that the law needs and the scenario's board, if it has one, lacks."""
    return scenario.board.lacks[law.bench_law] if scenario.board else None


@dataclass(frozen=True)
class Plan:
    """What the user asked for."""

    scenarios: Sequence[Scenario]
    target_scenarios: Sequence[str]  # names of those that run on the image
    laws: Sequence[Law]
    targets: Sequence[str]
    is_quick: bool
    settings: Sequence[str] = ()
    options: Sequence[str] = field(default_factory=list)  # seed, noise: passed to every run
    can: str | None = None  # channel of the target linux
    telemetry_every: int = 1  # ticks between two bursts of all words, targets OVER_CAN
    # Of the bench by its name of a law: the law's own tables, and parameters that go with them.
    tables: Mapping[str, Sequence[str]] = field(default_factory=dict)
    # Likewise: more parameters that go with them, which a board has in their place.
    bare: Mapping[str, Sequence[str]] = field(default_factory=dict)

    @property
    def constant_step_mA(self) -> int:
        return QUICK_CONSTANT_STEP_mA if self.is_quick else CONSTANT_STEP_mA

    @property
    def checked_target(self) -> str | None:
        """The target whose every reply is compared with the host's."""
        return next((target for target in self.targets if target != "host"), None)

    @property
    def has_rigs_only(self) -> bool:
        return all(scenario.board is not None for scenario in self.scenarios)

    def options_of(self, target: str, scenario: Scenario) -> list[str]:
        more = ["--telemetry-every", str(self.telemetry_every)] if target in OVER_CAN else []
        more += ["--can", self.can] if target == "linux" and self.can else []
        return target_options(target, more, scenario.board is not None)

    def law_options(self, law: Law, scenario: Scenario) -> list[str]:
        bare = () if scenario.board else self.bare.get(law.bench_law, ())
        return [
            "--law", law.bench_law, *self.tables.get(law.bench_law, ()), *bare,
            *setting_options([*self.settings, *law.settings]),
        ]  # fmt: skip

    def laws_on(self, target: str) -> list[Law]:
        """The quick plan runs on the image what tells most: the fuzzy law, and what it needs."""
        if target == "host" or not self.is_quick or self.targets == ["mps2"]:
            return list(self.laws)
        return [law for law in self.laws if law.name in (OPEN_LOOP, "fuzzy")]

    def cases(self) -> list[Case]:
        return [
            Case(scenario, law, target)
            for scenario in self.scenarios
            for target in self.targets
            if target == "host" or scenario.name in self.target_scenarios
            for law in self.laws_on(target)
            if lacked(scenario, law) is None
        ]

    def left_out(self) -> list[str]:
        """Of each law that cannot work with a board: why, in words."""
        return [
            f"{scenario.name}: {law.name} is left out, it needs {signal}, which no sensor of board "
            f"{scenario.board.name} provides"
            for scenario in self.scenarios
            for law in self.laws
            if (signal := lacked(scenario, law)) is not None
        ]

    def searches(self) -> list[Scenario]:
        if all(law.name != CONSTANT_BEST for law in self.laws):
            return []
        searched = [c.scenario for c in self.cases() if c.law.name == CONSTANT_BEST]
        return [s for s in self.scenarios if any(one is s for one in searched)]


class Runner:
    """Runs a plan on the bench, two runs at a time."""

    def __init__(self, bench: Bench, plan: Plan) -> None:
        self._bench = bench
        self.plan = plan
        # Refuses bad settings before anything runs.
        self._params = effective_params(bench, plan.settings)
        for case in plan.cases():
            plan.options_of(case.target, case.scenario)
        self._line = threading.Lock()  # one bench at a time talks over a CAN channel

    def run_all(self) -> tuple[list[Run], list[ConstantSearch]]:
        cases, search_in = self.plan.cases(), self.plan.searches()
        progress = Progress(len(cases) + len(search_in))
        searches = self._map(lambda scenario: self._search(scenario, progress), search_in)
        best_mA = {search.scenario.name: search.best_mA for search in searches}
        runs = self._map(lambda case: self._run(case, best_mA, progress), cases)
        return runs, searches

    def _map(self, work: Callable[[Any], Done], items: Sequence[Any]) -> list[Done]:
        return run_all(self._bench, [partial(work, item) for item in items])

    def _options(self, scenario: Scenario, law: Law, settings: Sequence[str]) -> list[str]:
        return [
            "--scenario", str(scenario.file), *self.plan.law_options(law, scenario),
            *setting_options(settings), *self.plan.options,
        ]  # fmt: skip

    def _search(self, scenario: Scenario, progress: Progress) -> ConstantSearch:
        law = next(law for law in self.plan.laws if law.name == CONSTANT_BEST)
        top_mA = self._params["max_current_mA"]
        if scenario.board:
            top_mA = min(top_mA, scenario.board.ceiling_mA)
        grid_mA = [*range(0, top_mA, self.plan.constant_step_mA), top_mA]
        figures = [
            self._bench.json("run", *self._options(scenario, law, [f"constant_current_mA={mA}"]))
            for mA in grid_mA
        ]
        search = ConstantSearch(scenario, grid_mA, figures)
        progress.done(
            f"{scenario.name}: {len(grid_mA)} constant currents, best {search.best_mA / 1000:g} A"
        )
        return search

    def _run(self, case: Case, best_mA: dict[str, int], progress: Progress) -> Run:
        settings = []
        if case.law.name == CONSTANT_BEST:
            settings = [f"constant_current_mA={best_mA[case.scenario.name]}"]
        options = self._options(case.scenario, case.law, settings)
        with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
            file = Path(folder) / "trace"
            options += [*self.plan.options_of(case.target, case.scenario), "--trace", str(file)]
            with self._line if case.target == "linux" else nullcontext():
                figures = self._bench.json("run", *options)
            trace = read_trace(file, [*TRACE_COLUMNS, *rig_columns(case.scenario)])
        progress.done(f"{case.scenario.name} {case.law.name} {case.target}: {headline(figures)}")
        return Run(case, figures, trace)


def rig_columns(scenario: Scenario) -> list[str]:
    """Of a trace: the truth of each body and damper, in um, mN and mA."""
    board = scenario.board
    if board is None:
        return []
    of_dampers = [f"{name}_true_{what}" for name in board.dampers for what in ("force_mN", "mA")]
    return [*(f"{name}_true_um" for name in board.bodies), *of_dampers]


def headline(figures: dict[str, Any]) -> str:
    kind = "RMS displacement" if figures["amp_um"] is None else "amplitude"
    text = f"{kind} {displacement_um(figures):.1f} um"
    if figures["disp_rms2_um"] is not None:
        text += f", then {displacement_um(figures, '2'):.1f} um"
    if figures["instr_median"] is not None:
        text += f", {figures['instr_median']} instructions a tick, at most {figures['instr_worst']}"
    return text


def measure_speed(
    bench: Bench, scenario: Scenario, law: Law, plan: Plan
) -> dict[str, float | None]:
    """Real-time factor of the closed loop, nothing else running here: the best of some repeats."""
    is_quick = plan.is_quick
    repeats = {"host": 20 if is_quick else 100, "mps2": 3 if is_quick else 5}
    factors: dict[str, float | None] = {"host": None, "mps2": None}
    for target in plan.targets:
        options = ["--scenario", str(scenario.file), *plan.law_options(law, scenario)]
        options += ["--repeat", str(repeats.get(target, 1)), *plan.options_of(target, scenario)]
        factors[target] = bench.json("run", *options)["realtime_factor"]
    return factors


def compare_traces(
    bench: Bench, scenario: Scenario, law: Law, seeds: Sequence[int], plan: Plan, target: str
) -> dict[str, Any]:
    """Every word of every reply that the target sends, against the host."""
    options = ["--scenario", str(scenario.file), *plan.law_options(law, scenario)]
    options += ["--seeds", ",".join(map(str, seeds)), *plan.options_of(target, scenario)]
    return bench.json("compare", *options)


def measure_uart(bench: Bench, exchanges: int) -> dict[str, Any]:
    return bench.json(
        "uart-rate", "--image", str(image("mps2-uart")), "--echo-image", str(echo_image()),
        "--exchanges", str(exchanges),
    )  # fmt: skip
