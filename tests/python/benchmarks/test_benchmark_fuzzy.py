"""The bench of the fuzzy engines: its random bases, its bound and its explanations on cases with a
known answer, and the command on a small budget."""

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.rules.formats.files import read_text, write_text
from quiesce.rules.integers.compile import compile_base
from quiesce.rules.model import CENTROID, METHODS, WEIGHTED_MAX, RuleBase, trapezoid, triangle
from quiesce.rules.reference import evaluate, input_memberships
from quiesce_benchmarks.cli import main
from quiesce_benchmarks.fuzzy import benchmark
from quiesce_benchmarks.fuzzy.agreement import (
    SAMPLING,
    SUMMED,
    UNEXPLAINED,
    Case,
    explain,
    judge_engine,
    judge_engines,
    lsb_of,
    make_case,
    sampled_centroid,
    summed,
)
from quiesce_benchmarks.fuzzy.benchmark import Size
from quiesce_benchmarks.fuzzy.cost import EngineCost, PeerCost, worst_instr
from quiesce_benchmarks.fuzzy.grid import Grid, GridResult
from quiesce_benchmarks.fuzzy.peers import built_peer, description, skfuzzy_holds
from quiesce_benchmarks.fuzzy.points import integers_of, random_points, rounding_range
from quiesce_benchmarks.fuzzy.random import STYLES, random_base
from quiesce_benchmarks.fuzzy.reference import MAX, SUM, VARIANTS, Variant, reference_base
from quiesce_benchmarks.fuzzy.sets import LAYOUTS, PARTITION, input_sets, output_sets
from quiesce_benchmarks.fuzzy.suite import Budget, judge_base
from quiesce_benchmarks.report import EXIT_ABSENT, Report

TINY = Size(20, 16, 1, Budget(bases=4, points=40, skfuzzy_points=2, straight_every=2))
FIGURES = [
    "singleton_engine_error_A", "singleton_end_to_end_error_A", "centroid_engine_error_A",
    "fuzzylite200_centroid_error_A", "compiled_singleton_worst_instr",
    "compiled_singleton_physical_worst_instr", "runtime_singleton_worst_instr",
    "compiled_centroid_worst_instr", "runtime_centroid_worst_instr", "product_and_instr",
    "sugeno_first_order_instr", "product_max_instr", "system_gaussian_4x4_instr",
    "system_sugeno_4x4_instr", "system_mamdani_100_instr", "system_mamdani_1000_instr",
    "surface_instr", "peer_fuzzylite_singleton_instr", "peer_fuzzylite_centroid_instr",
    "random_bases_tried", "random_bases_compiled_pct", "random_bases_beyond_bound",
    "foreign_files_compiled_pct", "foreign_worst_error_pct", "gaussian_4x4_bytes",
    "type2_worst_error_pct",
]  # fmt: skip


# Random bases


def test_base_is_a_function_of_seed_and_number() -> None:
    assert random_base(3, 7) == random_base(3, 7)
    assert random_base(3, 7).base != random_base(3, 8).base
    assert random_base(3, 7).base != random_base(4, 7).base


def test_all_kinds_occur() -> None:
    bases = [random_base(1, number) for number in range(200)]
    assert set(LAYOUTS) == {one.layout for one in bases}
    assert set(STYLES) == {one.style for one in bases}
    methods = Counter(output.method for one in bases for output in one.base.outputs)
    assert set(methods) == set(METHODS) and min(methods.values()) > 50
    assert {2, 3} == {len(one.base.inputs) for one in bases}
    assert {1, 2} == {len(one.base.outputs) for one in bases}
    assert {2, 3, 4, 5, 6, 7} == {len(v.sets) for one in bases for v in one.base.inputs}
    rules = [rule for one in bases for rule in one.base.rules]
    assert any(rule.connective == "or" for rule in rules)
    assert any(c.negated for rule in rules for c in rule.conditions)
    assert any(0 < rule.weight < 1 for rule in rules)
    assert any(
        len({rule.conditions for rule in one.base.rules}) < len(one.base.rules) for one in bases
    )


@pytest.mark.parametrize("number", range(0, 60, 3))
def test_base_is_well_formed_and_files_hold_it(number: int) -> None:
    base = random_base(2, number).base
    for variable in base.inputs:
        for one in variable.sets:
            x = [at for at, _ in one.points]
            assert x == sorted(x)
    for output in base.outputs:
        assert output.default is not None and output.minimum <= output.default <= output.maximum
    again = read_text(write_text(base, "fll"), "fll", base.name)
    points = random_points(base, [1e-3] * len(base.inputs), np.random.default_rng(1), 100)
    assert np.array_equal(
        evaluate(base, list(points.T)).outputs, evaluate(again, list(points.T)).outputs
    )


@pytest.mark.parametrize("count", [2, 4, 7])
def test_partition_adds_up_to_one(count: int) -> None:
    rng = np.random.default_rng(count)
    for _ in range(10):
        sets = input_sets(rng, PARTITION, count, -10.0, 10.0)
        total = input_memberships(sets, np.linspace(-10.0, 10.0, 501)).sum(axis=0)
        assert total == pytest.approx(1.0, abs=1e-9)


def test_output_sets_are_in_order() -> None:
    rng = np.random.default_rng(4)
    for _ in range(50):
        sets = output_sets(rng, 6, 0.0, 1.0)
        corners = np.array([[x for x, _ in one.points] for one in sets if len(one.points) == 4])
        assert (np.diff(corners, axis=0) >= 0).all()
        for one in sets:
            x = np.linspace(0.0, 1.0, 2001)
            assert max(one.membership(at) for at in x) > 0


# The bound


def test_points_reach_breakpoints_ends_and_beyond() -> None:
    base = reference_base(SUM)
    lsb = [25 / 32768, 20 / 32768]
    points = random_points(base, lsb, np.random.default_rng(1), 3000)
    assert (points[:, 0] < 0).any() and (points[:, 0] > 25).any()
    assert {0.0, 25.0} <= set(points[:, 0])
    assert (np.abs(points[:, 0, None] - np.array([3.0, 8.0, 13.0, 18.0])) < 4 * lsb[0]).any(0).all()


def test_integers_are_nearest_and_not_clamped_to_the_universe() -> None:
    compiled = compile_base(reference_base(SUM))
    points = np.array([[25 / 32768 * 10.4, -5.0], [1e9, 20.0 + 20 / 32768]])
    integers = integers_of(compiled, points)
    assert integers[0].tolist() == [10, 2**31 - 1 if 1e9 * 32768 / 25 > 2**31 else 0]
    assert integers[1].tolist() == [-8192, 32769]


@pytest.mark.parametrize("number", [0, 2, 8, 11, 24, 29])
def test_rounding_range_holds_the_reference_all_over_the_box(number: int) -> None:
    base = random_base(1, number).base
    lsb = [(v.maximum - v.minimum) / 32768 for v in base.inputs]
    rng = np.random.default_rng(number)
    points = random_points(base, lsb, rng, 300)
    allowed = rounding_range(base, points, lsb, lines=9)
    for _ in range(20):
        moved = points + rng.uniform(-0.5, 0.5, points.shape) * lsb
        found = evaluate(base, list(moved.T))
        for i, output in enumerate(base.outputs):
            slack = 2e-6 * (output.maximum - output.minimum)
            is_in = (found.outputs[i] >= allowed.low[i] - slack) & (
                found.outputs[i] <= allowed.high[i] + slack
            )
            assert np.where(found.is_default[i], allowed.has_default[i], is_in).all()


def case_of(base: RuleBase, count: int = 200) -> Case:
    random = replace(random_base(1, 0), base=base)
    return make_case(random, 1, count)


def test_engine_is_within_the_bound_on_the_reference_controller() -> None:
    for method in (SUM, MAX, CENTROID):
        for one in judge_engines(case_of(reference_base(method)), with_straight=True):
            assert one.beyond == 0 and one.worst_lsb <= 1.0, (method, one)


def test_engine_of_another_base_is_found_out() -> None:
    base = reference_base(SUM)
    case = case_of(base)
    allowed = rounding_range(base, case.points, lsb_of(case.compiled))
    output = base.outputs[0]
    moved = replace(output.terms[2], value=output.terms[2].value + 3 * 5 / 65536)
    terms = (*output.terms[:2], moved, *output.terms[3:])
    other = replace(base, outputs=(replace(output, terms=terms),))
    wrong = judge_engine(replace(case, compiled=compile_base(other)), "table", allowed)
    assert wrong.beyond > 0 and 1.0 < wrong.worst_lsb < 5.0


def test_default_where_a_rule_fires_is_found_out() -> None:
    base = reference_base(SUM)
    case = case_of(base)
    allowed = rounding_range(base, case.points, lsb_of(case.compiled))
    silent = replace(base, rules=base.rules[:1])
    wrong = judge_engine(replace(case, compiled=compile_base(silent)), "table", allowed)
    assert wrong.beyond > 0 and wrong.worst_lsb == np.inf


# Peers explained


def test_sampled_centroid_is_the_exact_one_in_the_limit() -> None:
    base = reference_base("centroid")
    case = case_of(base, 50)
    strengths = np.zeros((5, 50))
    for rule, strength in zip(base.rules, case.strengths, strict=True):
        np.maximum(strengths[rule.conclusions[0]], strength, out=strengths[rule.conclusions[0]])
    worst = [
        np.abs(sampled_centroid(base.outputs[0], strengths, n) - case.outputs[0]).max()
        for n in (100, 10000)
    ]
    assert worst[0] > 1e-5 and worst[1] < 1e-6


def test_peers_are_explained_or_not() -> None:
    base = reference_base(MAX)
    case = case_of(base)
    exact = case.outputs.T.copy()
    assert explain(case, "libfuzzylite", exact, 100).differing == {}
    told = explain(case, "libfuzzylite", summed(case).T, 100)
    assert set(told.differing) == {SUMMED} and told.worst_share > 0.01
    assert UNEXPLAINED in explain(case, "pyfuzzylite", summed(case).T, 100).differing
    exact[3, 0] += 1e-6
    assert explain(case, "pyfuzzylite", exact, 100).differing == {UNEXPLAINED: 1}


def test_peer_that_samples_is_explained_by_its_own_resolution() -> None:
    base = reference_base("centroid")
    case = case_of(base)
    terms = [rule.conclusions[0] for rule in base.rules]
    strengths = np.array([
        case.strengths[[i for i, term in enumerate(terms) if term == k]].max(axis=0)
        for k in range(5)
    ])  # fmt: skip
    sampled = sampled_centroid(base.outputs[0], strengths, 100)[:, None]
    assert set(explain(case, "pyfuzzylite", sampled, 100).differing) == {SAMPLING}
    assert UNEXPLAINED in explain(case, "pyfuzzylite", sampled, 200).differing


def test_scikit_fuzzy_is_given_what_it_can_hold() -> None:
    assert skfuzzy_holds(reference_base("centroid")) == ""
    assert "centroid" in skfuzzy_holds(reference_base(MAX))
    told = description(reference_base("centroid"))
    assert [len(one["sets"]) for one in told["inputs"]] == [4, 4] and len(told["rules"]) == 16
    assert told["inputs"][0]["sets"][0]["points"] == ((0.0, 1.0), (3.0, 1.0), (8.0, 0.0))
    base = reference_base("centroid")
    crisp = replace(base.inputs[0], sets=(trapezoid("S", 1, 1, 2, 2), *base.inputs[0].sets[1:]))
    assert "vertical" in skfuzzy_holds(replace(base, inputs=(crisp, base.inputs[1])))


# Figures of given results


def grid_of(singleton_A: float, centroid_A: float, sampled_A: float | None) -> GridResult:
    """Errors of a 2 x 2 grid, as given; the other ones are smaller, or not asked for."""
    grid = Grid(2)
    rows = [
        ("engine", Variant(SUM, "q15"), "table", singleton_A / 2),
        ("engine", Variant(MAX, "physical"), "table", singleton_A),
        ("end to end", Variant(MAX, "physical"), "table", 2e-4),
        ("end to end", Variant(MAX, "q15"), "table", 9e-4),
        ("engine", Variant("centroid", "q15"), "table", centroid_A),
    ]
    if sampled_A is not None:
        rows.append(("peer", "centroid", "libfuzzylite 6, 200 samples", sampled_A))
    zero = np.zeros(4)
    errors = [
        grid.error(what, one, of, "exact reference", zero, zero + e) for what, one, of, e in rows
    ]
    return GridResult(2, errors, [], {})


def accuracy(*values: float | None) -> dict[str, tuple]:
    figures = benchmark.accuracy_figures(grid_of(*values))
    return {one.name: (one.value, one.is_ok) for one in figures}


def test_accuracy_takes_the_worst_and_judges_it() -> None:
    found = accuracy(9e-5, 1.4e-4, 2.5e-4)
    assert found["singleton_engine_error_A"] == (pytest.approx(9e-5), True)
    assert found["singleton_end_to_end_error_A"] == (pytest.approx(2e-4), True)
    assert found["centroid_engine_error_A"] == (pytest.approx(1.4e-4), True)
    assert found["fuzzylite200_centroid_error_A"] == (pytest.approx(2.5e-4), None)
    assert accuracy(1.1e-4, 1.4e-4, 2.5e-4)["singleton_engine_error_A"][1] is False
    assert accuracy(9e-5, 1.6e-4, 2.5e-4)["centroid_engine_error_A"][1] is False
    assert accuracy(9e-5, 1.4e-4, 1e-4)["centroid_engine_error_A"][1] is False
    assert accuracy(9e-5, 1.4e-4, None)["fuzzylite200_centroid_error_A"] == (None, None)


def engine_cost(variant: Variant, kind: str, worst: int) -> EngineCost:
    return EngineCost(variant, kind, 100, worst, worst - 5, worst - 4.5, 1000, 0, 16)


def test_costs_take_the_worst_of_both_aggregations() -> None:
    worst = {SUM: 40, MAX: 45, "centroid": 110}
    engines = [
        engine_cost(variant, kind, worst[variant.method] + 10 * (variant.format == "physical"))
        for variant in VARIANTS
        for kind in ("table", "straight")
    ]
    peers = [PeerCost(n, 1000, 900 + n, 800, 700.0 + n, 500000, 1400) for n in (0, 100, 200)]
    costs = benchmark.Costs(engines, peers)
    found = {one.name: (one.value, one.is_ok) for one in benchmark.cost_figures(costs)}
    assert found["compiled_singleton_worst_instr"] == (45, True)
    assert found["compiled_singleton_physical_worst_instr"] == (55, True)
    assert found["runtime_singleton_worst_instr"] == (55, True)
    assert found["compiled_centroid_worst_instr"] == (120, True)
    assert found["peer_fuzzylite_singleton_instr"] == (700.0, None)
    assert found["peer_fuzzylite_centroid_instr"] == (800.0, None)
    assert benchmark.ratios(costs)["centroid_200"] == pytest.approx(900 / 120)
    assert worst_instr([], "table", [SUM]) is None


def test_figures_without_measurement_are_not_met_goals() -> None:
    figures = [
        *benchmark.cost_figures(benchmark.Costs()),
        *benchmark.random_figures(None),
    ]
    assert all(one.value is None for one in figures)
    assert Report("fuzzy", figures, {}).exit_code(is_checked=True) == EXIT_ABSENT


def test_base_that_the_integers_cannot_hold_is_told_not_counted(monkeypatch) -> None:
    base = reference_base("centroid")
    no_area = (triangle("t", 2.5, 2.5, 2.5),) * 5
    empty = replace(base, outputs=(replace(base.outputs[0], terms=no_area),))
    random = replace(random_base(1, 0), base=empty)
    monkeypatch.setattr("quiesce_benchmarks.fuzzy.suite.random_base", lambda seed, number: random)
    assert "area" in str(judge_base(0, 1, TINY.random))


def test_two_aggregations_differ_by_what_was_published() -> None:
    grid = Grid(500)
    off = np.abs(grid.exact(SUM) - grid.exact(MAX)).max()
    assert off == pytest.approx(0.335, abs=2e-3)
    assert reference_base(MAX).outputs[0].method == WEIGHTED_MAX


# The command


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture):
    """`./tools/benchmark fuzzy` on a tiny budget, where nothing is built and no peer can be had."""
    monkeypatch.setenv("QUIESCE_BUILD", str(tmp_path / "build"))
    monkeypatch.setattr(benchmark, "QUICK", TINY)
    monkeypatch.chdir(tmp_path)

    def run(*options: str) -> tuple[int, str]:
        code = main(["fuzzy", "--quick", "--out", "out", *options])
        return code, capsys.readouterr().out

    return run


@pytest.mark.slow
def test_command_prints_every_figure_and_tells_what_is_absent(bench, tmp_path: Path) -> None:
    code, printed = bench("--json", "--check", "--no-cost")
    report = json.loads(printed)
    figures = {figure["name"]: figure for figure in report["figures"]}
    assert list(figures) == FIGURES
    for name in FIGURES[:3]:
        assert figures[name]["ok"] is True
    assert figures["fuzzylite200_centroid_error_A"]["value"] is None
    assert figures["compiled_singleton_worst_instr"]["value"] is None
    # A tiny budget tries too few bases, which is a missed goal.
    assert figures["random_bases_tried"]["value"] <= 4 and code == 1
    assert figures["random_bases_beyond_bound"]["value"] is None
    absent = "\n".join(report["context"]["absent"])
    assert figures["foreign_files_compiled_pct"]["value"] is None
    assert 0 < figures["gaussian_4x4_bytes"]["value"] <= 8192
    peers = ("libfuzzylite 6: ", "pyfuzzylite 8: ", "fetch_peers fuzzylite", "fetch_peers foreign")
    for words in ("--no-cost", *peers):
        assert words in absent
    assert json.loads((tmp_path / "out/fuzzy.json").read_text()) == report
    assert "<svg" in (tmp_path / "out/fuzzy_errors.svg").read_text()


@pytest.mark.slow
def test_command_without_peers_cannot_judge(bench) -> None:
    code, printed = bench("--check", "--no-random")
    assert code == EXIT_ABSENT
    assert "not judged" in printed and "--no-random" in printed
    assert "is not built" in printed or "qemu-system-arm" in printed


def test_missing_peer_says_what_to_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("QUIESCE_BUILD", str(tmp_path))
    with pytest.raises(UsageError, match=r"run \./tools/benchmarks/fetch_peers python"):
        built_peer("python")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--seed", "-1"], "--seed"),
        (["--seed", "x"], "--seed"),
        (["--sides", "3"], "--sides"),
        (["extra"], "extra"),
    ],
)
def test_bad_option_is_refused(refused, options: list[str], words: str) -> None:
    assert words in refused("bench", "fuzzy", *options)
