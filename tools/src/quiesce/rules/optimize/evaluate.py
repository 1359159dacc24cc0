"""What a rule base does to the structure: the controller with it in closed loop, on the bench.

The one place that knows how a rule base reaches the bench: compiled to a table, in a file, by its
option `run --rules`.
"""

import hashlib
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import how_to_build
from quiesce.engine.bench import Bench, bench_file, setting_options
from quiesce.engine.laws import CONSTANT_BEST, OPEN_LOOP, find
from quiesce.engine.scenarios import Scenario, read_toml
from quiesce.hil.metrics import excitation_text
from quiesce.hil.runs import Case, Run, displacement_um, reduction_pct
from quiesce.rules.integers.controller import controller_file
from quiesce.rules.model import RuleBase
from quiesce.rules.optimize.objective import Outcome, Steady


@dataclass(frozen=True)
class Place:
    """One window of one scenario."""

    scenario: Scenario
    window: int
    freq_Hz: float  # 0: no one frequency
    drive_V: float
    amp_um: float  # at 0 A: amplitude of the displacement; its RMS where there is no one frequency
    accel_rms_mm_s2: float  # at 0 A

    @property
    def label(self) -> str:
        return f"{self.scenario.name}, {excitation_text(self.freq_Hz)}"


def require_bench_option(bench: Bench) -> None:
    if "--rules" not in bench.call("--help"):
        raise UsageError(f"the bench that is built takes no rules; {how_to_build()}")


def bench_digest() -> str:
    """Of the executable, so that results of another build are not taken for those of this one."""
    return hashlib.sha256(bench_file().read_bytes()).hexdigest()[:16]


def driver_max_A(scenarios: Sequence[Scenario]) -> float:
    """The largest current that any of the plants' drivers gives."""
    return max(float(read_toml(s.plant_file)["driver"]["max_current_A"]) for s in scenarios)


class ClosedLoop:
    """The scenarios, with their figures at 0 A. Calls may come from several threads."""

    def __init__(
        self,
        bench: Bench,
        scenarios: Sequence[Scenario],
        settings: Sequence[str] = (),
        options: Sequence[str] = (),
    ) -> None:
        """settings: NAME=VALUE for every run. options: of the bench, such as the noise."""
        self._bench = bench
        self._scenarios = scenarios
        self._settings = settings
        self._options = options
        self._at_rest = [self._run(scenario, find(OPEN_LOOP).bench_law) for scenario in scenarios]
        self.places = [place for run in self._at_rest for place in places_of(run)]

    def with_options(self, options: Sequence[str]) -> "ClosedLoop":
        """The same under other options of the bench."""
        return ClosedLoop(self._bench, self._scenarios, self._settings, options)

    def of_rules(self, base: RuleBase) -> Outcome:
        with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
            file = Path(folder) / "rules.table"
            file.write_bytes(controller_file(base))
            return self._outcome("fuzzy", ("--rules", str(file)))

    def of_constant(self, current_mA: int) -> Outcome:
        law = find(CONSTANT_BEST).bench_law
        return self._outcome(law, setting_options([f"constant_current_mA={current_mA}"]))

    def _outcome(self, law: str, options: Sequence[str]) -> Outcome:
        found: list[Steady] = []
        for at_rest in self._at_rest:
            run = self._run(at_rest.case.scenario, law, options)
            pairs = zip(run.figures["windows"], at_rest.figures["windows"], strict=True)
            found += [steady(ours, base) for ours, base in pairs]
        return tuple(found)

    def _run(self, scenario: Scenario, law: str, options: Sequence[str] = ()) -> Run:
        words = [
            "--scenario", str(scenario.file), "--law", law, "--target", "host",
            *setting_options(self._settings), *self._options, *options,
        ]  # fmt: skip
        return Run(Case(scenario, find(OPEN_LOOP), "host"), self._bench.json("run", *words), {})


def places_of(at_rest: Run) -> list[Place]:
    found = []
    for number, window in enumerate(at_rest.figures["windows"]):
        freq_Hz, accel_mm_s2 = window["freq_hz"], window["accel_rms_mm_s2"]
        if not displacement_um(window) or not accel_mm_s2:
            raise UsageError(
                f"scenario {at_rest.case.scenario.name} does not vibrate at "
                f"{excitation_text(freq_Hz)} with 0 A; nothing can be reduced there"
            )
        drive_V = at_rest.figures["drive_V"]
        found.append(Place(at_rest.case.scenario, number, freq_Hz, drive_V,
                           displacement_um(window), accel_mm_s2))  # fmt: skip
    return found


def steady(ours: dict[str, Any], base: dict[str, Any]) -> Steady:
    """Of a window, and of the same one at 0 A."""
    return Steady(
        reduction_pct(displacement_um(ours), displacement_um(base)) or 0.0,
        reduction_pct(ours["accel_rms_mm_s2"], base["accel_rms_mm_s2"]) or 0.0,
        ours["mean_current_A"],
    )
