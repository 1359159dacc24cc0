"""A rule base as a table of law `fuzzy_signals`: its inputs are signals, its output a current."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import floor, log2

from quiesce.base.errors import UsageError
from quiesce.law.forms.fuzzy_signals import (
    MOST_SHIFT,
    MOST_SLOPES,
    FuzzySection,
    FuzzySignalsTable,
    Meaning,
    ONE_mA_Q8,
    Slope,
)
from quiesce.law.rig import LawRig
from quiesce.law.signal import BY_NAME, Input
from quiesce.rules.integers.compile import compile_base
from quiesce.rules.integers.rule_words import read_rules
from quiesce.rules.integers.table import table_words
from quiesce.rules.model import RuleBase, Singleton

SLOPE_COUNTS = 2**22  # of the steepest slope
LEAST = 1e-30  # counts
MOST_SPAN_A = 60.0  # of an output: 2^24 counts
PATTERN = re.compile(r"(?:(?P<factor>[-+.\deE]+)\s+)?(?P<bar>\|?)(?P<signal>[^|]+)(?P<end>\|?)")


@dataclass(frozen=True)
class Source:
    """What an input of rules is: factor x a signal in SI units. place: a body or damper by number;
    None: the damper's own, and of a body its end a."""

    quantity: str
    place: int | None = None
    factor: float = 1.0
    is_magnitude: bool = False


def read_source(rig: LawRig, text: str) -> Source:
    """`[FACTOR] QUANTITY [of PLACE]`, its signal between bars for its magnitude. ValueError, in
    one line, where it is not that."""
    found = PATTERN.fullmatch(text.strip())
    if found is None or found["bar"] != found["end"]:
        raise ValueError(f"expected [FACTOR] QUANTITY [of PLACE], perhaps |...|, found '{text}'")
    name, _, place = found["signal"].strip().partition(" of ")
    if name not in BY_NAME:
        raise ValueError(f"no quantity '{name}'; there are: {', '.join(BY_NAME)}")
    factor = _factor(found["factor"])
    at = _place(rig, name, place) if place else None
    return Source(name, at, factor, bool(found["bar"]))


def _factor(text: str | None) -> float:
    try:
        factor = 1.0 if text is None else float(text)
    except ValueError:
        factor = 0.0
    if not 1e-9 <= factor <= 1e9:
        raise ValueError(f"expected a factor in 1e-9 .. 1e9, found '{text}'")
    return factor


def _place(rig: LawRig, quantity: str, name: str) -> int:
    places = rig.bodies if BY_NAME[quantity].of == "body" else tuple(d.name for d in rig.dampers)
    if name not in places:
        raise ValueError(f"{quantity} of '{name}'; there are: {', '.join(places)}")
    return places.index(name)


def sources_of(rig: LawRig, base: RuleBase, words: Sequence[str]) -> tuple[Source, ...]:
    """Of every input, from NAME=SOURCE words; one that none names is by its own name the signal.
    UsageError where that does not do."""
    given = dict(_pair(base, word) for word in words)
    found = []
    for variable in base.inputs:
        text = given.get(variable.name, variable.name.replace("_", " "))
        try:
            found.append(read_source(rig, text))
        except ValueError as error:
            raise UsageError(f"input {variable.name}: {error}; say --map '{variable.name}=SIGNAL'")
    return tuple(found)


def _pair(base: RuleBase, word: str) -> tuple[str, str]:
    name, equals, text = word.partition("=")
    names = [one.name for one in base.inputs]
    if not equals or name not in names:
        raise UsageError(f"--map {word}: expected NAME=SIGNAL of an input: {', '.join(names)}")
    return name, text


def table_of_rules(
    rig: LawRig, base: RuleBase, sources: Sequence[Source], per_output_A: float
) -> FuzzySignalsTable:
    """For each damper; per_output_A: what 1 of the rules' output is. UsageError or ValueError, in
    one line, where the board has no such signal or the integers cannot hold the rules."""
    if len(base.outputs) != 1:
        names = ", ".join(one.name for one in base.outputs)
        raise UsageError(f"{base.name} has outputs {names}; a law takes rules of one output")
    inputs = [_inputs(rig, base, sources, i) for i in range(len(rig.dampers))]
    first_order, of = with_slopes(base)
    lsbs, shifts = _output_lsbs(first_order, of, sources, inputs[0], per_output_A)
    input_lsbs = [
        source.factor / one.per_unit for source, one in zip(sources, inputs[0], strict=True)
    ]
    rules = read_rules(table_words(compile_base(first_order, input_lsbs, lsbs)))
    slopes = tuple(Slope(*pair) for pair in zip(of, shifts, strict=True))
    flags = tuple(one.is_magnitude for one in sources)
    meaning = Meaning(first_order, tuple(one.factor for one in sources), per_output_A)
    return FuzzySignalsTable(
        tuple(FuzzySection(one, flags, slopes, rules, meaning) for one in inputs)
    )


def _inputs(
    rig: LawRig, base: RuleBase, sources: Sequence[Source], damper: int
) -> tuple[Input, ...]:
    """Limited to the universe: beyond it its ends hold."""
    found = []
    for variable, source in zip(base.inputs, sources, strict=True):
        at = source.place
        if at is None:
            at = rig.dampers[damper].a if BY_NAME[source.quantity].of == "body" else damper
        reach = max(abs(variable.minimum), abs(variable.maximum)) / source.factor
        found.append(Input.of(rig.input(source.quantity, at).signal, reach))
    return tuple(found)


def with_slopes(base: RuleBase) -> tuple[RuleBase, tuple[int, ...]]:
    """Straight lines as outputs of their own: constants first, then the slopes over each input that
    has any; and which inputs those are. The same rules conclude on all, with the same strengths, so
    that the sum of constant + slopes x inputs is the average of the lines. UsageError where there
    are more than the firmware has outputs."""
    output = base.outputs[0]
    lines = [one for one in output.terms if isinstance(one, Singleton) and one.slopes]
    if not lines:
        return base, ()
    of = tuple(i for i in range(len(base.inputs)) if any(one.slopes[i] for one in lines))
    if len(of) > MOST_SLOPES:
        raise UsageError(f"{base.name} has slopes over {len(of)} inputs; at most {MOST_SLOPES}")
    columns = [[one.value for one in output.terms]]
    columns += [[one.slopes[i] if one.slopes else 0.0 for one in output.terms] for i in of]
    names = [output.name, *(f"per {base.inputs[i].name}" for i in of)]
    defaults = [output.default, *(0.0 for _ in of)]
    outputs = tuple(
        replace(
            output,
            name=name,
            minimum=min(values),
            maximum=max(values),
            terms=tuple(
                Singleton(term.name, value)
                for term, value in zip(output.terms, values, strict=True)
            ),
            default=default,
        )
        for name, values, default in zip(names, columns, defaults, strict=True)
    )
    rules = tuple(replace(one, conclusions=one.conclusions * len(outputs)) for one in base.rules)
    return replace(base, outputs=outputs, rules=rules), of


def _output_lsbs(
    base: RuleBase,
    of: Sequence[int],
    sources: Sequence[Source],
    inputs: Sequence[Input],
    per_output_A: float,
) -> tuple[list[float], list[int]]:
    """Of every output, so that 1 is 2^-8 mA and, of a slope, that x 2^shift for 1 of its input; and
    the shifts."""
    first = base.outputs[0]
    span_A = (first.maximum - first.minimum) * per_output_A
    if span_A > MOST_SPAN_A:
        raise UsageError(f"output {first.name} spans {span_A:g} A; at most {MOST_SPAN_A:g}")
    lsbs, shifts = [1.0 / (1e3 * ONE_mA_Q8 * per_output_A)], []
    for i, output in zip(of, base.outputs[1:], strict=True):
        scale = 1e3 * ONE_mA_Q8 * per_output_A * sources[i].factor / inputs[i].per_unit
        steepest = max(abs(output.minimum) * scale, abs(output.maximum) * scale, LEAST)
        shift = min(MOST_SHIFT, floor(log2(SLOPE_COUNTS / steepest)))
        if shift < 0:
            raise UsageError(f"a slope {output.name} of {steepest / scale:g} is too steep")
        lsbs.append(1.0 / (scale * 2.0**shift))
        shifts.append(shift)
    return lsbs, shifts
