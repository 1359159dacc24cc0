"""All laws on the frozen cantilever in one table, beside an independent simulation's figures and
the bound of optimal control."""

import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.errors import UsageError, one_line
from quiesce.base.table import format_table
from quiesce.engine import laws
from quiesce.engine.bench import Bench, setting_options
from quiesce.engine.params import parameters
from quiesce.engine.pool import run_all, run_work
from quiesce.hil.published import Reference, load_reference
from quiesce.law.recipe import Recipe
from quiesce.law.recipes import RECIPES
from quiesce.law.rig import LawRig
from quiesce.table.file import table_bytes

from quiesce_benchmarks.laws import cantilever_rig as rig
from quiesce_benchmarks.laws.cantilever_rig import Cantilever, Control, Outcome
from quiesce_benchmarks.laws.scaled_settings import DECADES, Sizes, trials
from quiesce_benchmarks.part import Effort, Measured

TITLE = "cantilever: all laws on the frozen plant, tuned by the same number of trials"
FIGURES = (
    ("cantilever_simulated_worst_pts", "points", 0.2, "lower"),
    ("cantilever_selftune_apart_pts", "points", None, "lower"),
    ("cantilever_laws", "laws", None, "higher"),
    ("cantilever_recipes_above_constant", "recipes", None, "higher"),
    ("cantilever_best_recipe_pct", "%", None, "higher"),
    ("cantilever_best_constant_pct", "%", None, "higher"),
    ("cantilever_bound_pct", "%", None, "higher"),
)
TRIALS, QUICK_TRIALS = 60, 8
CONSTANTS = 11  # from 0 to all that the driver gives
# What is usual here, on the twin in N, and on the building that defaults are for.
HERE = Sizes(N=1.7, m=6e-5, s=1.0 / (2.0 * np.pi * 10.0), A=2.5)
THERE = Sizes(N=500.0, m=2e-3, s=1.0 / (2.0 * np.pi * 5.5), A=1.1)
GAIN = "tracker_gain_mA_kN"
MAP = "inverse"  # the tracker that works with a map, which is made here


@dataclass(frozen=True)
class Row:
    """A law. steady: at each of FREQS_Hz; step: 10 to 20 Hz, reductions in both windows."""

    name: str
    tracker: str
    on: int | None  # Control.on
    steady: tuple[Outcome, ...]
    step: Outcome
    settings: dict[str, float] = field(default_factory=dict)

    @property
    def score_pct(self) -> float:
        return score_pct(self.steady)


def score_pct(steady: Sequence[Outcome]) -> float:
    """Mean of both reductions over the frequencies: what every recipe's settings are chosen by."""
    return float(np.mean([(*one.amp_pct, *one.accel_pct) for one in steady]))


class Runs:
    """The scenarios, on the plant and on its twin."""

    def __init__(self, bench: Bench, made: Cantilever, seed: int) -> None:
        self.bench, self.made, self._seed = bench, made, seed
        scenarios = [*map(rig.steady, rig.FREQS_Hz), rig.STEP]
        self._files = {
            on: [rig.scenario_file(made, one, on) for one in scenarios] for on in (None, 0, 1)
        }
        self._off = {on: self._figures(Control("off", (), on)) for on in (None, 0, 1)}

    def _figures(self, control: Control) -> list[dict[str, Any]]:
        files = self._files[control.on]
        return [rig.run(self.bench, file, control, self._seed) for file in files]

    def steady(self, control: Control) -> tuple[Outcome, ...]:
        files = self._files[control.on][:-1]
        return tuple(
            rig.outcome(rig.run(self.bench, file, control, self._seed), off)
            for file, off in zip(files, self._off[control.on], strict=False)
        )

    def step(self, control: Control) -> Outcome:
        file, off = self._files[control.on][-1], self._off[control.on][-1]
        return rig.outcome(rig.run(self.bench, file, control, self._seed), off)

    def row(self, name: str, control: Control) -> Row:
        return Row(name, "", control.on, self.steady(control), self.step(control))


def constants(runs: Runs) -> list[Row]:
    """0 A, all of it, and at each frequency and in each reduction the best of the grid."""
    most_mA = round(1e3 * rig.most_A())
    grid = [round(most_mA * i / (CONSTANTS - 1)) for i in range(CONSTANTS)]
    controls = [
        Control("constant", tuple(setting_options([f"constant_current_mA={mA}"]))) for mA in grid
    ]
    rows = run_all(runs.bench, [partial(runs.row, "constant", one) for one in controls])
    best = max(rows, key=lambda row: row.score_pct)
    current_A = 1e-3 * grid[rows.index(best)]
    return [
        replace(rows[0], name="no current"),
        replace(rows[-1], name=f"constant {1e-3 * most_mA:g} A"),
        replace(best, name=f"best constant, {current_A:g} A"),
    ]


def of_firmware(runs: Runs) -> list[Row]:
    """The laws that `./tools/hil` compares, without constants."""
    found = [one for one in laws.LAWS if one.bench_law not in ("off", "constant")]
    controls = [Control(one.bench_law, tuple(setting_options(one.settings))) for one in found]
    tasks = [
        (one.name, partial(runs.row, one.name, control))
        for one, control in zip(found, controls, strict=True)
    ]
    return list(run_work(runs.bench, tasks))


def gain_of(recipe: Recipe, trial: int, seed: int) -> list[str]:
    """Of tracker proportional: all current for a usual force, and around that."""
    if recipe.tracker != "proportional":
        return []
    most = next(one["max"] for one in parameters() if one["name"] == GAIN)
    rng = np.random.default_rng([seed, trial])
    spread = 1.0 if trial == 0 else 10.0 ** rng.uniform(-DECADES, DECADES)
    return [f"{GAIN}={min(most, round(2e6 * HERE.A / HERE.N * spread))}"]


def control_of(
    recipe: Recipe, made: Cantilever, rigs: tuple[LawRig, LawRig], values: dict[str, float],
    settings: Sequence[str], file: Path,
) -> Control:  # fmt: skip
    """Its table in that file. UsageError where the rig or the settings do not allow it."""
    found, needs_cell = rig.made_for(rigs, recipe, values)
    file.write_bytes(table_bytes(found.table.words()))
    tracker = [f"tracker={recipe.tracker}"] if recipe.tracker else []
    of_map = ["--force-map", str(made.force_map)] if recipe.tracker == MAP else []
    options = ["--law-table", str(file), *of_map, *setting_options([*tracker, *settings])]
    return Control(found.table.law, tuple(options), int(needs_cell))


def of_recipe(
    runs: Runs, rigs: tuple[LawRig, LawRig], recipe: Recipe, count: int, seed: int
) -> Row | str:
    """The best of its trials, or why there is none."""
    best: tuple[float, Control, tuple[Outcome, ...], dict[str, float]] | None = None
    refused = ""
    for number, values in enumerate(trials(recipe, HERE, THERE, count, seed)):
        file = runs.made.structure.parent / f"{recipe.name}_{number}.table"
        gain = gain_of(recipe, number, seed)
        try:
            control = control_of(recipe, runs.made, rigs, values, gain, file)
            steady = runs.steady(control)
        except UsageError as error:
            refused = one_line(str(error))
            continue
        score = score_pct(steady)
        if best is None or score > best[0]:
            own = {GAIN: float(gain[0].partition("=")[2])} if gain else {}
            best = (score, control, steady, {**values, **own})
    if best is None:
        return f"{recipe.name}: {refused}"
    _, control, steady, settings = best
    return Row(recipe.name, recipe.tracker, control.on, steady, runs.step(control), settings)


def simulated_apart_pts(row: Row, name: str, reference: Reference) -> float:
    """Largest difference of a reduction from the independent simulation's of that name; 0 where it
    has none."""
    apart = [0.0]
    for freq_Hz, one in zip(rig.FREQS_Hz, row.steady, strict=True):
        theirs = reference.simulated_for(f"sine_{freq_Hz:g}Hz", name, freq_Hz)
        for key, ours in (
            ("amp_reduction_pct", one.amp_pct[0]),
            ("accel_rms_reduction_pct", one.accel_pct[0]),
        ):
            apart.append(abs(ours - theirs.get(key, ours)))
    return max(apart)


def measure(effort: Effort) -> Measured:
    count = QUICK_TRIALS if effort.is_quick else TRIALS
    reference = load_reference()
    with tempfile.TemporaryDirectory(prefix="quiesce-laws-") as name:
        made = rig.make_rig(Path(name))
        runs = Runs(Bench(), made, effort.seed)
        rigs = rig.law_rigs(made)
        fixed, own = constants(runs), of_firmware(runs)
        work = [
            (one.name, partial(of_recipe, runs, rigs, one, count, effort.seed)) for one in RECIPES
        ]
        done = run_work(runs.bench, work)
    recipes = [one for one in done if isinstance(one, Row)]
    left_out = [one for one in done if isinstance(one, str)]
    best_constant = fixed[-1]
    bounds = [reference.bounds[freq_Hz] for freq_Hz in rig.FREQS_Hz]
    apart = {row.name: simulated_apart_pts(row, row.name, reference) for row in own}
    apart["constant_best"] = simulated_apart_pts(fixed[1], "constant_best", reference)
    values: dict[str, float | None] = {
        "cantilever_simulated_worst_pts": max(apart["constant_best"], apart["fuzzy"]),
        "cantilever_selftune_apart_pts": max(apart[name] for name in apart if "selftune" in name),
        "cantilever_laws": len(own) + len(recipes),
        "cantilever_recipes_above_constant": sum(
            row.score_pct > best_constant.score_pct for row in recipes
        ),
        "cantilever_best_recipe_pct": max(row.score_pct for row in recipes),
        "cantilever_best_constant_pct": best_constant.score_pct,
        "cantilever_bound_pct": float(np.mean(bounds)),
    }
    rows = [*fixed, *own, *sorted(recipes, key=lambda row: -row.score_pct)]
    reported = {
        "trials": count,
        "rows": {row.name: {**asdict(row), "score_pct": row.score_pct} for row in rows},
        "simulated": simulated_rows(reference),
        "bound": {"amp_pct": [a for a, _ in bounds], "accel_pct": [a for _, a in bounds]},
        "left_out": left_out,
    }
    text = format_table(list(HEAD), table_rows(reported), (0, 1))
    return Measured(values, reported, ("\n".join([text, *(f"not here: {x}" for x in left_out)]),))


def simulated_rows(reference: Reference) -> dict[str, dict[str, list[float | None]]]:
    """Of the independent simulation, by law: both reductions at the four frequencies."""
    names = dict.fromkeys(
        name
        for case in reference.simulated
        for name in case
        if isinstance(case[name], dict) and "amp_reduction_pct" in case[name]
    )

    def at(name: str, key: str) -> list[float | None]:
        return [
            reference.simulated_for(f"sine_{freq_Hz:g}Hz", name, freq_Hz).get(key)
            for freq_Hz in rig.FREQS_Hz
        ]

    found = {
        name: {
            "amp_pct": at(name, "amp_reduction_pct"),
            "accel_pct": at(name, "accel_rms_reduction_pct"),
        }
        for name in names
    }
    return {name: row for name, row in found.items() if None not in row["amp_pct"]}


HEAD = ("law", "tracker", "displacement, %", "acceleration, %", "mean of both", "mean A",
        "step: displacement", "RMS 4 .. 6 s, um")  # fmt: skip
DIVIDER = " / "


def _each(values: Sequence[float | None]) -> str:
    return DIVIDER.join("-" if value is None else f"{value:.1f}" for value in values)


def table_rows(reported: dict[str, Any]) -> list[list[str]]:
    """Of what was reported, fresh or committed: the laws, then what they are compared with."""
    rows = [law_cells(name, row) for name, row in reported["rows"].items()]
    rows += [
        [f"{name}, simulated", "", _each(row["amp_pct"]), _each(row["accel_pct"]), *_empty(4)]
        for name, row in reported["simulated"].items()
    ]
    bound = reported["bound"]
    rows.append(["bound", "", _each(bound["amp_pct"]), _each(bound["accel_pct"]), *_empty(4)])
    return rows


def _empty(count: int) -> list[str]:
    return [""] * count


def law_cells(name: str, row: dict[str, Any]) -> list[str]:
    steady, step = row["steady"], row["step"]
    return [
        name,
        row["tracker"],
        _each([one["amp_pct"][0] for one in steady]),
        _each([one["accel_pct"][0] for one in steady]),
        f"{row['score_pct']:.1f}",
        _each([one["mean_current_A"] for one in steady]),
        _each(step["amp_pct"]),
        f"{step['transient_rms_um']:.2f}",
    ]
