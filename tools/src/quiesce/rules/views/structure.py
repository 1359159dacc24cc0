"""Where two rule bases differ in what they say: sets, methods, defaults, rules; in words."""

from collections.abc import Iterator, Sequence
from typing import Any

from quiesce.rules.analysis.findings import number
from quiesce.rules.formats.same import plain_points
from quiesce.rules.model import FuzzySet, Input, Output, Rule, RuleBase, Singleton


def structural_differences(one: RuleBase, other: RuleBase) -> list[str]:
    """In words; the two are matched. The order of sets and rules does not count."""
    found: list[str] = []
    for a, b in zip(one.inputs, other.inputs, strict=True):
        found += universe_differences("input", a, b)
        found += term_differences(f"input {a.name}", "set", a.sets, b.sets)
    for a, b in zip(one.outputs, other.outputs, strict=True):
        found += universe_differences("output", a, b)
        if a.method != b.method:
            found.append(f"output {a.name}: method {a.method} against {b.method}")
        if a.default != b.default:
            found.append(f"output {a.name}: {default_text(a)} against {default_text(b)}")
        found += term_differences(f"output {a.name}", "term", a.terms, b.terms)
    return [*found, *rule_differences(one, other)]


def default_text(output: Output) -> str:
    return "no default" if output.default is None else f"default {number(output.default)}"


def universe_differences(kind: str, a: Input | Output, b: Input | Output) -> list[str]:
    if (a.minimum, a.maximum) == (b.minimum, b.maximum):
        return []
    return [
        f"{kind} {a.name}: universe {number(a.minimum)} .. {number(a.maximum)} against "
        f"{number(b.minimum)} .. {number(b.maximum)}"
    ]


def term_differences(
    place: str, kind: str, ours: Sequence[Any], theirs: Sequence[Any]
) -> Iterator[str]:
    there = {term.name: term for term in theirs}
    here = {term.name for term in ours}
    for term in ours:
        if term.name not in there:
            yield f"{place}: {kind} {term.name} is in A only"
        elif shape(term) != shape(there[term.name]):
            yield (
                f"{place}: {kind} {term.name} {shape_text(term)} against "
                f"{shape_text(there[term.name])}"
            )
    for term in theirs:
        if term.name not in here:
            yield f"{place}: {kind} {term.name} is in B only"


def shape(term: FuzzySet | Singleton) -> object:
    return term.value if isinstance(term, Singleton) else plain_points(term.points)


def shape_text(term: FuzzySet | Singleton) -> str:
    if isinstance(term, Singleton):
        return number(term.value)
    return " ".join(f"({number(x)}, {number(mu)})" for x, mu in plain_points(term.points))


def rule_differences(one: RuleBase, other: RuleBase) -> Iterator[str]:
    """Rules by their conditions: what the same conditions conclude, and rules of one only."""
    ours, theirs = rules_by_conditions(one), rules_by_conditions(other)
    for key in [*ours, *(key for key in theirs if key not in ours)]:
        mine, its = list(ours.get(key, [])), list(theirs.get(key, []))
        for said in [said for said in mine if said in its]:
            if said in mine and said in its:
                mine.remove(said)
                its.remove(said)
        text = condition_text(key)
        for a, b in zip(mine, its, strict=False):
            yield f"rule {text}: {said_text(a)} against {said_text(b)}"
        yield from (f"rule {text}: {said_text(a)} is in A only" for a in mine[len(its) :])
        yield from (f"rule {text}: {said_text(b)} is in B only" for b in its[len(mine) :])


Key = tuple[str, tuple[tuple[str, bool, str], ...]]
Said = tuple[tuple[str, ...], float]


def rules_by_conditions(base: RuleBase) -> dict[Key, list[Said]]:
    found: dict[Key, list[Said]] = {}
    for rule in base.rules:
        found.setdefault(conditions_key(base, rule), []).append(said_by(base, rule))
    return found


def conditions_key(base: RuleBase, rule: Rule) -> Key:
    names = [v.name for v in base.inputs]
    conditions = sorted(
        {
            (names[c.input], c.negated, base.inputs[c.input].sets[c.set].name)
            for c in rule.conditions
        },
        key=lambda c: (names.index(c[0]), c[2], c[1]),
    )
    return (rule.connective if len(conditions) > 1 else "and", tuple(conditions))


def said_by(base: RuleBase, rule: Rule) -> Said:
    terms = tuple(
        f"{output.name} IS {output.terms[term].name}"
        for output, term in zip(base.outputs, rule.conclusions, strict=True)
        if term is not None
    )
    return terms, rule.weight


def condition_text(key: Key) -> str:
    word = f" {key[0].upper()} "
    return word.join(
        f"{name} IS {'NOT ' if negated else ''}{term}" for name, negated, term in key[1]
    )


def said_text(said: Said) -> str:
    terms, weight = said
    return ", ".join(terms) + ("" if weight == 1 else f" WITH {number(weight)}")
