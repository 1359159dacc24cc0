"""Closed-loop runs for `./tools/benchmark control`: which controller, which plant, what came out.

Every run is made once, however many parts of the bench ask for it.
"""

import tempfile
import threading
import tomllib
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench, setting_options
from quiesce.engine.params import effective_params
from quiesce.engine.pool import Work, run_work
from quiesce.engine.trace import Trace, read_trace

from quiesce_benchmarks.control.measures import reduction_pct
from quiesce_benchmarks.control.scenarios import Scenario

DISPLACEMENT, BALANCED = "displacement", "balanced"
SETTINGS = (DISPLACEMENT, BALANCED)
# Bounds of the displacement are at any price in acceleration; so is the law that is judged by them.
ANY_ACCEL = "phase_accel_floor_pct=-100"


@dataclass(frozen=True)
class Control:
    """A law and its parameters."""

    law: str
    settings: tuple[str, ...] = ()
    options: tuple[str, ...] = ()  # of the bench: a law's table

    def with_settings(self, *settings: str) -> "Control":
        return Control(self.law, (*self.settings, *settings), self.options)

    def words(self) -> list[str]:
        return ["--law", self.law, *setting_options(self.settings), *self.options]


OPEN_LOOP = Control("off")


def constant(current_A: float) -> Control:
    return Control("constant", (f"constant_current_mA={round(1e3 * current_A)}",))


@dataclass(frozen=True)
class Judged:
    """The law under test. A law without settings or adaptation is the same in each of them."""

    law: str
    settings: tuple[str, ...]  # the user's
    options: tuple[str, ...]
    adapts: bool

    def control(self, setting: str, adapt: str = "on") -> Control:
        own = (f"phase_setting={setting}", f"adapt={adapt}") if self.adapts else ()
        free = (ANY_ACCEL,) if self.adapts else ()
        return Control(self.law, (*free, *self.settings, *own), self.options)

    def with_options(self, options: Sequence[str]) -> "Judged":
        return replace(self, options=tuple(options))


@dataclass(frozen=True)
class Run:
    figures: dict[str, Any]  # the bench's own
    trace: Trace | None


@dataclass(frozen=True)
class Reduction:
    """One run against 0 A, in its last window."""

    amp_pct: float
    accel_pct: float
    mean_current_A: float


@dataclass(frozen=True)
class Plant:
    """A plant file. Hashable by its path: files are not changed while the bench runs."""

    file: Path
    max_current_A: float = field(compare=False)
    drive_V: float = field(compare=False)
    coil_rise_s: float = field(compare=False)


def read_plant(bench: Bench, file: Path) -> Plant:
    """UsageError, in the bench's words, where it is not a plant."""
    bench.call("plant-check", str(file))
    data = tomllib.loads(file.read_text(encoding="utf-8"))
    return Plant(
        file.resolve(),
        float(data["driver"]["max_current_A"]),
        float(data["shaker"]["drive_V"]),
        float(data["coil"]["rise_s"]),
    )


class Rig:
    """Runs scenarios; from several threads at once."""

    def __init__(
        self,
        bench: Bench,
        plant: Plant,
        judged: Judged,
        params: dict[str, int],
        seed: int,
        folder: Path,
    ) -> None:
        self.bench = bench
        self.plant = plant
        self.judged = judged
        self.params = params  # that the judged law runs with
        self.folder = folder  # for files that go with the run
        self._seed = seed
        self._lock = threading.Lock()
        self._runs: dict[Any, Future[Run]] = {}

    @property
    def full_A(self) -> float:
        """All that the driver and the controller's limit give."""
        return min(self.plant.max_current_A, 1e-3 * self.params["max_current_mA"])

    @property
    def unlock_A(self) -> float:
        """Commanded while the frequency is not known."""
        return min(self.full_A, 1e-3 * self.params["unlock_current_mA"])

    @property
    def run_count(self) -> int:
        return len(self._runs)

    def run(
        self,
        scenario: Scenario,
        control: Control,
        plant: Plant | None = None,
        columns: Sequence[str] = (),
        every: int = 1,
    ) -> Run:
        """columns: of the trace, every so many ticks; no trace without them."""
        key = (scenario, control, plant or self.plant, tuple(columns), every)
        with self._lock:
            known = self._runs.get(key)
            mine: Future[Run] | None = None if known else Future()
            if mine:
                self._runs[key] = mine
        if mine is None:
            assert known is not None
            return known.result()
        try:
            mine.set_result(self._run(*key))
        except BaseException as error:
            mine.set_exception(error)
        return mine.result()

    def run_once(
        self,
        scenario: Scenario,
        control: Control,
        plant: Plant,
        columns: Sequence[str],
        every: int = 1,
    ) -> Run:
        """As run, but nobody else will ask: hundreds of long traces are not kept."""
        return self._run(scenario, control, plant, columns, every)

    def _run(
        self, scenario: Scenario, control: Control, plant: Plant, columns: Sequence[str], every: int
    ) -> Run:
        with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
            options = self.options(scenario, control, plant, Path(folder))
            trace_file = Path(folder) / "trace"
            if columns:
                options += ["--trace", str(trace_file), "--columns", ",".join(columns)]
                options += ["--every", str(every)]
            figures = self.bench.json("run", *options, "--seed", str(self._seed))
            return Run(figures, read_trace(trace_file) if columns else None)

    def options(
        self, scenario: Scenario, control: Control, plant: Plant, folder: Path
    ) -> list[str]:
        """Of the bench, the scenario written into a folder. Without seed and target."""
        file = folder / "scenario.toml"
        file.write_text(scenario.text(plant.file), encoding="utf-8")
        return ["--scenario", str(file), *control.words()]

    def reduction(
        self, scenario: Scenario, control: Control, plant: Plant | None = None
    ) -> Reduction:
        """In the scenario's only window."""
        base = self.run(scenario, OPEN_LOOP, plant).figures
        mine = self.run(scenario, control, plant).figures
        return Reduction(
            reduction_pct(mine["amp_um"], base["amp_um"]),
            reduction_pct(mine["accel_rms_mm_s2"], base["accel_rms_mm_s2"]),
            mine["mean_current_A"],
        )

    def work(self, pieces: Sequence[Work]) -> list[Any]:
        """Results in order, progress on stderr."""
        return run_work(self.bench, pieces)


def fitted(plant: Plant, params: dict[str, int]) -> list[str]:
    """Settings without which the controller does not fit the plant's driver and coil."""
    full_mA = round(1e3 * plant.max_current_A)
    names = ("max_current_mA", "constant_current_mA", "unlock_current_mA", "safe_current_mA")
    limits = [f"{name}={full_mA}" for name in names if params[name] > full_mA]
    return [f"current_lag_ms={round(1e3 * plant.coil_rise_s)}", *limits]


def make_judged(
    bench: Bench, law: str, settings: Sequence[str], plant: Plant
) -> tuple[Judged, dict[str, int]]:
    """The law, and the parameters that it runs with. UsageError where there is no such law."""
    known = {param["name"]: param for param in bench.json("params")}
    laws = known["law"]["labels"]
    if law not in laws:
        raise UsageError(f"--law {law}: no such law; there are: {', '.join(laws)}")
    chosen = [*fitted(plant, effective_params(bench, [])), *settings]
    params = effective_params(bench, chosen)
    return Judged(law, tuple(chosen), (), adapts=law == "phase"), params


def grid_A(highest_A: float, step_A: float) -> list[float]:
    """0 .. highest, both included."""
    count = max(1, round(highest_A / step_A))
    return [highest_A * i / count for i in range(count + 1)]
