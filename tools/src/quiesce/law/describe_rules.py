"""A table of law `fuzzy_signals` in words: sets in SI units and a rule a line, or their grid."""

from quiesce.base.table import format_table
from quiesce.law.forms.fuzzy_signals import FuzzySection, FuzzySignalsTable, ONE_mA_Q8
from quiesce.law.forms.rule_words import Rule
from quiesce.law.signal import Input


def described_rules(table: FuzzySignalsTable) -> list[str]:
    parts, shown = [], None
    for i, section in enumerate(table.sections):
        same = section.rules == shown
        parts.append(
            f"damper {i + 1}" + (": the same rules" if same else "") + "\n" + _sets(section)
        )
        if not same:
            parts.append(_rules(section))
        shown = section.rules
    return parts


def _name(section: FuzzySection, number: int) -> str:
    name = section.inputs[number].signal.name
    return f"|{name}|" if section.is_magnitude[number] else name


def _sets(section: FuzzySection) -> str:
    rows = []
    for i, (one, axis) in enumerate(zip(section.inputs, section.rules.axes, strict=True)):
        for number, places in axis.sets.items():
            name = f"{i + 1}: {_name(section, i)}" if number == min(axis.sets) else ""
            rows.append([name, str(number + 1), *(_si(one, n) for n in places)])
    return format_table(["input", "set", "from", "to", "greatest at"], rows, (0,))


def _si(one: Input, n: int) -> str:
    """Beyond the limit of the input there is nothing; what is less than a count of it is 0."""
    inside = min(max(n, -one.largest), one.largest)
    value = inside / one.per_unit if abs(inside) >> one.shift else 0.0
    return f"{value:.4g} {one.signal.quantity.unit}"


def _rules(section: FuzzySection) -> str:
    rules = section.rules.rules
    if len(section.inputs) == 2 and all(map(_is_of_a_pair, rules)):
        return _grid(section)
    head = ["rule", "if", "then"]
    rows = [[str(i + 1), _conditions(rule), _then(section, rule)]
            for i, rule in enumerate(rules)]  # fmt: skip
    return format_table(head, rows, (1, 2))


def _is_of_a_pair(rule: Rule) -> bool:
    inputs = [one[0] for one in rule.conditions]
    is_plain = not rule.is_or and rule.weight == 1 and not any(c[2] for c in rule.conditions)
    return is_plain and sorted(inputs) == [0, 1]


def _grid(section: FuzzySection) -> str:
    first, second = (sorted(axis.sets) for axis in section.rules.axes)
    cells = {}
    for rule in section.rules.rules:
        place = {number: a_set for number, a_set, _ in rule.conditions}
        cells[place[0], place[1]] = _then(section, rule)
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


def _then(section: FuzzySection, rule: Rule) -> str:
    """The current, and of a straight line what each of its signals adds."""
    term, *slopes = rule.conclusions
    parts = []
    if term is not None:
        values = section.rules.outputs[0].values
        parts.append(f"{1e-3 * values[term] / ONE_mA_Q8:.4g} A" if values else f"set {term + 1}")
    for slope, output, number in zip(
        section.slopes, section.rules.outputs[1:], slopes, strict=True
    ):
        if number is not None and output.values and output.values[number]:
            one = section.inputs[slope.input]
            gain = 1e-3 * output.values[number] / ONE_mA_Q8 * one.per_unit / 2.0**slope.shift
            parts.append(f"{gain:+.4g} A per {one.signal.quantity.unit} of {slope.input + 1}")
    return " ".join(parts)
