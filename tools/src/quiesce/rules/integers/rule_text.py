"""A table of rules in words: sets and a rule a line, or their grid."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from quiesce.base.table import format_table
from quiesce.rules.integers.rule_words import HIGHEST, LOWEST, Rule, Rules


@dataclass(frozen=True)
class Told:
    """An input: its name, and a number of it with its unit."""

    name: str
    value: Callable[[int], str]


# The ends of all integers are no place.
ENDS = {LOWEST: "lowest", HIGHEST: "highest"}


def _in_millionths(unit: str) -> Callable[[int], str]:
    return lambda n: ENDS.get(n) or f"{1e-6 * n:.4g} {unit}"


FOR_CONTROLLER = (
    Told("frequency", _in_millionths("Hz")),
    Told("RMS acceleration", _in_millionths("m/s2")),
)


def described(rules: Rules) -> str:
    """For the controller in its units, else in the table's own."""
    if rules.is_for_controller:
        return "\n\n".join(
            [sets_text(rules, FOR_CONTROLLER), rules_text(rules, _currents_of(rules))]
        )
    told = [Told(f"input {i + 1}", lambda n: ENDS.get(n) or str(n)) for i in range(len(rules.axes))]
    return "\n\n".join([sets_text(rules, told), rules_text(rules, _terms_of(rules))])


def _currents_of(rules: Rules) -> Callable[[Rule], str]:
    values = rules.outputs[0].values

    def told(rule: Rule) -> str:
        term = rule.conclusions[0]
        return "" if term is None else current_text(values, term, 1e-3)

    return told


def _terms_of(rules: Rules) -> Callable[[Rule], str]:
    def told(rule: Rule) -> str:
        parts = []
        for output, term in zip(rules.outputs, rule.conclusions, strict=True):
            if term is not None:
                parts.append(f"{output.values[term]:g}" if output.values else f"set {term + 1}")
            else:
                parts.append("-")
        return ", ".join(parts)

    return told


def current_text(values: Sequence[float], term: int, unit_A: float) -> str:
    """Of a term that may be a set."""
    return f"{unit_A * values[term]:.4g} A" if values else f"set {term + 1}"


def sets_text(rules: Rules, inputs: Sequence[Told]) -> str:
    rows = []
    for i, (one, axis) in enumerate(zip(inputs, rules.axes, strict=True)):
        for number, places in axis.sets.items():
            name = f"{i + 1}: {one.name}" if number == min(axis.sets) else ""
            rows.append([name, number + 1, *map(one.value, places)])
    return format_table(["input", "set", "from", "to", "greatest at"], rows, (0,))


def rules_text(rules: Rules, then: Callable[[Rule], str]) -> str:
    if len(rules.axes) == 2 and all(map(_is_of_a_pair, rules.rules)):
        return _grid(rules, then)
    rows = [(i, _conditions(rule), then(rule)) for i, rule in enumerate(rules.rules, start=1)]
    return format_table(["rule", "if", "then"], rows, (1, 2))


def _is_of_a_pair(rule: Rule) -> bool:
    inputs = [one[0] for one in rule.conditions]
    is_plain = not rule.is_or and rule.weight == 1 and not any(c[2] for c in rule.conditions)
    return is_plain and sorted(inputs) == [0, 1]


def _grid(rules: Rules, then: Callable[[Rule], str]) -> str:
    first, second = (sorted(axis.sets) for axis in rules.axes)
    cells = {}
    for rule in rules.rules:
        place = {number: a_set for number, a_set, _ in rule.conditions}
        cells[place[0], place[1]] = then(rule)
    head = ["if", *(f"2 is {k + 1}" for k in second)]
    rows = [[f"1 is {i + 1}", *(cells.get((i, k), "") for k in second)] for i in first]
    return format_table(head, rows, (0,))


def _conditions(rule: Rule) -> str:
    parts = [
        f"{i + 1} is {'not ' if negated else ''}{number + 1}"
        for i, number, negated in rule.conditions
    ]
    weight = "" if rule.weight == 1 else f", weight {rule.weight:g}"
    return (" or " if rule.is_or else " and ").join(parts) + weight
