"""Measured dampers, held out: baselines and our models, by
tools/benchmarks/dampers/scoring.toml."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.paths import measurements, root
from quiesce.base.table import format_table
from quiesce.damper.data.records import records_of_set
from quiesce.damper.data.split import Segment, split_records
from quiesce.damper.fit_model import simulate_values
from quiesce.damper.fitted import BLACK_BOX, PARAMETRIC, Fitted
from quiesce.damper.identify import identify
from quiesce.damper.ranking import best, ranked
from quiesce.damper.score import Score, score
from quiesce.damper.task import Plan

from quiesce_benchmarks.damper.baselines import fit_baseline
from quiesce_benchmarks.report import Figure

RULES = "tools/benchmarks/dampers/scoring.toml"

# What `./tools/benchmark identify` fits to every set; --models all adds every other one.
MODELS = (
    "normalised_bouc_wen",
    "viscoplastic_1",
    "viscoplastic_2",
    "viscoplastic_3",
    "viscoplastic_3_free",
    "hysteresis_network",
    "grey_box",
)

# Those of `--quick`: minutes each; the others take half an hour and more.
QUICK_SETS = ("utfsm_sweep_0A", "utfsm_sweep_1A", "sano")

# Set -> largest unexplained ratio and error.
GOALS = {
    "utfsm_sweep_0A": (0.38, 0.079),
    "utfsm_sweep_1A": (0.05, 0.042),
    "utfsm_sines": (0.22, 0.080),
    "dyke_switched": (0.11, 0.112),
    "sano": (0.09, 0.135),
}
LAGGED_GOAL = 0.25


@dataclass(frozen=True)
class Baseline:
    name: str
    train: Score
    test: Score


@dataclass(frozen=True)
class SetResult:
    name: str
    fitted: list[Fitted]
    baselines: list[Baseline]
    lagged: list[Baseline]

    @property
    def winner(self) -> Fitted:
        """By validation inside the training part."""
        return ranked(self.fitted)[0]

    def figures(self) -> list[Figure]:
        ratio, error = GOALS.get(self.name, (None, None))
        baseline = best_baseline(self.baselines)
        winners = {"best": self.winner, **categories(self.fitted)}
        out = [
            Figure(
                f"error_{self.name}_{what}",
                one.test.mean_error if one.test else None,
                "1",
                error if what == "best" else None,
                "lower",
            )
            for what, one in winners.items()
        ]
        out.append(
            Figure(f"error_{self.name}_baseline", baseline.test.mean_error, "1", None, "lower")
        )
        out.append(
            Figure(
                f"unexplained_ratio_{self.name}",
                unexplained(self.winner, self.baselines),
                "1",
                ratio,
                "lower",
            )
        )
        if self.lagged:
            value = unexplained(self.winner, self.lagged)
            out.append(Figure("unexplained_ratio_dyke_lagged", value, "1", LAGGED_GOAL, "lower"))
        return out

    def table(self) -> str:
        """Every model, best validation first, and the baselines."""
        plain = best_baseline(self.baselines)
        rows = [model_row(one, unexplained(one, self.baselines)) for one in ranked(self.fitted)]
        for one in [*self.baselines, *self.lagged]:
            what = "baseline with lag" if one in self.lagged else "baseline"
            ratio = one.test.squared_error_N2 / plain.test.squared_error_N2
            rows.append(
                [one.name, what, "", "-", *map(percent, (one.train.error,)), "-"]
                + [percent(one.test.mean_error), f"{ratio:.3f}", ""]
            )
        head = ["model", "kind", "passive", "numbers", "train %", "validation %", "test %"]
        return f"{self.name}\n" + format_table([*head, "ratio", "s"], rows, left=(0, 1, 2))


def model_row(one: Fitted, ratio: float) -> list[str]:
    return [
        one.name,
        one.kind,
        one.passivity.text,
        str(one.parameter_count),
        percent(one.train.error),
        percent(one.validation_error),
        percent(one.test.mean_error) if one.test else "-",
        f"{ratio:.3f}",
        f"{one.seconds:.0f}",
    ]


def percent(value: float) -> str:
    return f"{100.0 * value:.2f}"


def categories(fitted: Sequence[Fitted]) -> dict[str, Fitted]:
    """The winners of the categories, as far as there are any."""
    found = best(fitted)
    names = {
        "best_parametric": PARAMETRIC,
        "best_passive": "passive",
        "best_black_box": BLACK_BOX,
    }
    return {name: found[key] for name, key in names.items() if key in found}


def best_baseline(baselines: Sequence[Baseline]) -> Baseline:
    return min(baselines, key=lambda one: one.test.squared_error_N2)


def unexplained(one: Fitted, baselines: Sequence[Baseline]) -> float:
    """Squared error of ours over the better baseline's, on the test rows."""
    if one.test is None:
        raise ValueError("a set without test rows")
    return one.test.squared_error_N2 / best_baseline(baselines).test.squared_error_N2


def data_folder() -> Path | None:
    """Where the measurements are, or None."""
    folder = measurements("mr_damper")
    return folder.parent if folder.is_dir() else None


def rules() -> dict[str, Any]:
    with (root() / RULES).open("rb") as file:
        return tomllib.load(file)


def parts_of(entry: Mapping[str, Any], folder: Path) -> tuple[list[Segment], list[Segment]]:
    data = records_of_set(entry, folder, rules()["displacement_low_pass_Hz"])
    return split_records(data.records, data.split)


def baselines_of(
    train: Sequence[Segment], test: Sequence[Segment], seed: int, starts: int, with_lag: bool
) -> list[Baseline]:
    out = []
    for name in rules()["baselines"]:
        problem, found = fit_baseline(name, train, seed, starts, with_lag)
        simulate = simulate_values(problem, found.values)
        out.append(Baseline(name, score(simulate, train), score(simulate, test)))
    return out


def run_set(
    entry: Mapping[str, Any],
    folder: Path,
    models: Sequence[str],
    seed: int,
    quick: bool,
    jobs: int,
    say: Callable[[str], None],
) -> SetResult:
    """Baselines and models of one set."""
    train, test = parts_of(entry, folder)
    starts = rules()["baseline_starts"]
    baselines = baselines_of(train, test, seed, starts, False)
    lagged = baselines_of(train, test, seed, starts, True) if entry.get("lagged_baseline") else []
    say(f"{entry['name']}: baselines")
    fitted = identify(
        train,
        test,
        Plan(models, seed=seed, quick=quick, jobs=jobs, seconds=1e6),
        told=lambda one: say(
            f"{entry['name']}: {one.name}, validation {percent(one.validation_error)} %"
        ),
    )
    return SetResult(entry["name"], fitted, baselines, lagged)
