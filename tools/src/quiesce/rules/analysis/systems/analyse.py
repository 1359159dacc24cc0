"""What is wrong, or looks wrong, with a system of any kind, and what holds of its outputs."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from quiesce.rules.analysis.analyse import nothing_uses, worst_first
from quiesce.rules.analysis.coverage import Region, instead_of, region_findings
from quiesce.rules.analysis.findings import (
    CONTRADICTORY,
    DISCONTINUOUS,
    DUPLICATE,
    EMPTY,
    ERROR,
    NOTE,
    PROVED,
    SAMPLED,
    UNCOVERED,
    UNREACHABLE,
    WARNING,
    Finding,
    rule_place,
)
from quiesce.rules.analysis.monotone import (
    TOLERANCE,
    Core,
    View,
    finding_of,
    reversals_in,
)
from quiesce.rules.analysis.systems.jumps import Jump, Jumps, jumps
from quiesce.rules.analysis.systems.reach import reach, why_it_may_jump
from quiesce.rules.analysis.systems.sample import Sample, place_text, sampled
from quiesce.rules.analysis.systems.signs import membership_at
from quiesce.rules.analysis.systems.support import Support, corners, support
from quiesce.rules.system.fold import propositions
from quiesce.rules.system.model import (
    BY_TERM,
    SET_METHODS,
    Conclusion,
    FormulaTerm,
    SetTerm,
    System,
    SystemInput,
    SystemOutput,
)
from quiesce.rules.system.norms import MAXIMUM
from quiesce.rules.system.reference import WEAKEST, evaluate
from quiesce.rules.system.rule_text import rule_text

TURN_POINTS, TURN_POINTS_OF_SETS = 10_000, 2_000  # of a sweep
CORE_STEPS = 512
TOLD = 0.01  # of an output's range: a jump as large as this is a warning


@dataclass(frozen=True)
class Fact:
    """Something that holds of an output. basis: of findings.py."""

    output: str
    what: str
    text: str
    basis: str


@dataclass(frozen=True)
class Analysis:
    findings: tuple[Finding, ...]
    facts: tuple[Fact, ...]


def analyse_system(system: System) -> Analysis:
    proved, points, steps = support(system), sampled(system), jumps(system)
    findings = [
        *coverage_findings(system, proved, points),
        *unused_findings(system),
        *empty_findings(system, proved),
        *silent_findings(system, proved, points),
        *pair_findings(system),
        *(jump_finding(system, jump) for jump in steps.found),
        *(finding_of(system, one) for one in reversals_in(system, view_of(system))),
    ]
    facts = [
        fact
        for i in range(len(system.outputs))
        for fact in facts_of(system, i, proved, points, steps)
    ]
    return Analysis(tuple(worst_first(findings)), tuple(facts))


# ---- where no rule fires ------------------------------------------------------------------------


def coverage_findings(system: System, proved: Support, points: Sample) -> Iterator[Finding]:
    for index, output in enumerate(system.outputs):
        regions = sorted(proved.uncovered[index], key=lambda region: -region.share)
        yield from region_findings(output, system, regions)
        silent = ~points.output_fires[index] & ~inside(regions, points.x)
        if silent.any():
            instead, severity = instead_of(output.default)
            text = (
                f"no rule for {output.name} fires at {silent.sum():,} of {silent.size:,} sampled "
                f"points elsewhere, such as {place_text(system, points.x[:, np.argmax(silent)])}: "
                f"{instead}"
            )
            yield Finding(UNCOVERED, severity, text, f"output {output.name}", SAMPLED)


def inside(regions: Sequence[Region], x: np.ndarray) -> np.ndarray:
    """[point]: whether it lies in one of the regions, which are open where they have a width."""
    found = np.zeros(x.shape[1], dtype=bool)
    for region in regions:
        within = [
            (values >= piece.start) & (values <= piece.end)
            for piece, values in zip(region.pieces, x, strict=True)
        ]
        found |= np.all(within, axis=0)
    return found


# ---- what no rule needs -------------------------------------------------------------------------


def unused_findings(system: System) -> Iterator[Finding]:
    asked = [one for rule in system.rules for one in propositions(rule.expression)]
    concluded = [one for rule in system.rules for one in rule.conclusions]
    for i, variable in enumerate(system.inputs):
        used = {one.term for one in asked if one.is_input and one.variable == i}
        if not used and is_in_values(system, i):
            continue
        yield from nothing_uses("input", variable.name, variable.terms, used, "asks for")
    for i, output in enumerate(system.outputs):
        used = {one.term for one in concluded if one.output == i}
        yield from nothing_uses("output", output.name, output.terms, used, "concludes")


def is_in_values(system: System, index: int) -> bool:
    """Whether an output's terms are functions of this input."""
    terms = [term for output in system.outputs for term in output.terms]
    return any(
        getattr(term, "input", None) == index
        or (isinstance(term, FormulaTerm) and index in dict(term.inputs).values())
        or (hasattr(term, "slopes") and term.slopes[index] != 0.0)
        for term in terms
    )


def empty_findings(system: System, proved: Support) -> Iterator[Finding]:
    for i, k in proved.empty:
        variable = system.inputs[i]
        name = variable.terms[k].name
        text = f"{name} of input {variable.name} is 0 all over the universe"
        yield Finding(EMPTY, WARNING, text, f"input {variable.name}, {name}")
    for i, output in enumerate(system.outputs):
        if output.method not in SET_METHODS:
            continue
        used = {c.term for rule in system.rules for c in rule.conclusions if c.output == i}
        for k, term in enumerate(output.terms):
            if k in used and isinstance(term, SetTerm) and not is_seen(output, term):
                place = f"output {output.name}, {term.name}"
                text = f"{term.name} of output {output.name} is 0 at all places of its universe: "
                yield Finding(EMPTY, ERROR, f"{text}rules that conclude it say nothing", place)


def is_seen(output: SystemOutput, term: SetTerm) -> bool:
    part = (output.maximum - output.minimum) / output.places
    places = output.minimum + part * (np.arange(output.places) + 0.5)
    return bool((membership_at(term.curve, places) > 0.0).any())


def silent_findings(system: System, proved: Support, points: Sample) -> Iterator[Finding]:
    for i, rule in enumerate(system.rules):
        text = rule_text(system, rule)
        if i in proved.silent:
            yield Finding(
                UNREACHABLE, WARNING, f"{rule_place(i)} never fires: {text}", rule_place(i)
            )
        elif not points.rule_fires[i].any():
            size = points.x.shape[1]
            told = f"{rule_place(i)} fires at none of {size:,} sampled points: {text}"
            yield Finding(UNREACHABLE, WARNING, told, rule_place(i), SAMPLED)


def pair_findings(system: System) -> Iterator[Finding]:
    """Rules of the same conditions that conclude otherwise, or the same."""
    groups: dict[object, list[int]] = {}
    for i, rule in enumerate(system.rules):
        groups.setdefault((system.blocks[rule.block], rule.expression), []).append(i)
    for first, second in sorted(p for group in groups.values() for p in combinations(group, 2)):
        for one in system.rules[first].conclusions:
            for other in system.rules[second].conclusions:
                if one.output == other.output:
                    yield pair_finding(system, first, second, one, other)


def pair_finding(
    system: System, first: int, second: int, one: Conclusion, other: Conclusion
) -> Finding:
    output, place = system.outputs[one.output], rule_place(second)
    text = rule_text(system, system.rules[first])
    if one.term != other.term:
        names = [output.terms[c.term].name for c in (one, other)]
        told = f"conclude {output.name} IS {names[0]} and {output.name} IS {names[1]}"
        return Finding(
            CONTRADICTORY, WARNING,
            f"{rule_place(first)} and {place} have the same conditions, but {told}: {text}", place,
        )  # fmt: skip
    is_greatest = output.aggregation == MAXIMUM and output.method in (BY_TERM, *SET_METHODS)
    effect = "the stronger one counts" if is_greatest else "both count"
    return Finding(
        DUPLICATE, WARNING,
        f"{place} repeats {rule_place(first)} for {output.name}, {effect}: {text}", place,
    )  # fmt: skip


# ---- jumps and turns ----------------------------------------------------------------------------


def jump_finding(system: System, jump: Jump) -> Finding:
    output, place = system.outputs[jump.output], place_text(system, jump.at)
    share = jump.height / (output.maximum - output.minimum)
    to = ", to or from its default" if jump.to_default else ""
    text = (
        f"{output.name} jumps along {system.inputs[jump.input].name} by {jump.height:.3g} "
        f"({100 * share:.2g} % of its range){to}, at {place}"
    )
    severity = WARNING if share >= TOLD else NOTE
    return Finding(DISCONTINUOUS, severity, text, place, SAMPLED)


def view_of(system: System) -> View:
    def values(axes: Sequence[np.ndarray]) -> np.ndarray:
        grid = np.broadcast_arrays(*axes)
        answer = evaluate(system, [one.ravel() for one in grid])
        is_weak = answer.strongest < WEAKEST
        found = np.where(answer.is_default | is_weak, np.nan, answer.outputs)
        return found.reshape(-1, *grid[0].shape)

    has_sets = any(one.method in SET_METHODS for one in system.outputs)
    return View(
        tuple(cores(variable) for variable in system.inputs),
        tuple(middled(corners(variable)) for variable in system.inputs),
        values,
        tuple(map(turn_tolerance, system.outputs)),
        TURN_POINTS_OF_SETS if has_sets else TURN_POINTS,
    )


def turn_tolerance(output: SystemOutput) -> float:
    """Sets are looked at in places: their values go by steps."""
    return 2.0 / output.places if output.method in SET_METHODS else TOLERANCE


def middled(at: Sequence[float]) -> np.ndarray:
    places = np.array(at)
    return np.sort(np.concatenate([places, 0.5 * (places[1:] + places[:-1])]))


def cores(variable: SystemInput) -> list[Core]:
    """Where each term is greatest; one that is as great everywhere has none."""
    steps = np.linspace(variable.minimum, variable.maximum, CORE_STEPS + 1)
    x = np.union1d(steps, corners(variable))
    found = []
    for term in variable.terms:
        mu = membership_at(term.curve, x)
        at_top = x[mu == mu.max()]
        is_everywhere = at_top[0] == variable.minimum and at_top[-1] == variable.maximum
        if mu.max() > 0 and not is_everywhere:
            found.append((float(at_top[0]), float(at_top[-1]), term.name))
    return sorted(found)


# ---- what holds of an output --------------------------------------------------------------------


def facts_of(
    system: System, index: int, proved: Support, points: Sample, steps: Jumps
) -> Iterator[Fact]:
    name = system.outputs[index].name
    yield coverage_fact(system, index, proved, points)
    bounds = reach(system, index)
    if bounds is not None:
        text = f"within {bounds[0]:.6g} .. {bounds[1]:.6g} where a rule fires"
        yield Fact(name, "range", text, PROVED)
    reasons = why_it_may_jump(system, index, proved.covered[index])
    if not reasons:
        yield Fact(name, "jumps", "none: it is continuous", PROVED)
        return
    count = sum(jump.output == index for jump in steps.found)
    found = "told above" if count else f"none along {steps.lines} lines"
    yield Fact(name, "jumps", f"{found}; possible by {', '.join(reasons)}", SAMPLED)


def coverage_fact(system: System, index: int, proved: Support, points: Sample) -> Fact:
    name, cells = system.outputs[index].name, f"in {proved.cells:,} cells"
    if proved.covered[index]:
        return Fact(name, "coverage", f"a rule fires everywhere, {cells}", PROVED)
    fires = points.output_fires[index]
    if fires.all():
        return Fact(name, "coverage", f"a rule fires at all of {fires.size:,} points", SAMPLED)
    text = f"a rule fires at {fires.sum():,} of {fires.size:,} points, many of them at corners"
    return Fact(name, "coverage", text, SAMPLED)
