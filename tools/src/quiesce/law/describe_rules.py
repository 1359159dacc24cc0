"""A table of law `fuzzy_signals` in words: sets in SI units and a rule a line, or their grid."""

from functools import partial

from quiesce.law.forms.fuzzy_signals import FuzzySection, FuzzySignalsTable, ONE_mA_Q8
from quiesce.law.signal import Input
from quiesce.rules.integers.rule_text import Told, current_text, rules_text, sets_text
from quiesce.rules.integers.rule_words import Rule


def described_rules(table: FuzzySignalsTable) -> list[str]:
    parts, shown = [], None
    for i, section in enumerate(table.sections):
        same = section.rules == shown
        told = [Told(_name(section, k), partial(_si, one)) for k, one in enumerate(section.inputs)]
        head = f"damper {i + 1}" + (": the same rules" if same else "")
        parts.append(f"{head}\n{sets_text(section.rules, told)}")
        if not same:
            parts.append(rules_text(section.rules, partial(_then, section)))
        shown = section.rules
    return parts


def _name(section: FuzzySection, number: int) -> str:
    name = section.inputs[number].signal.name
    return f"|{name}|" if section.is_magnitude[number] else name


def _si(one: Input, n: int) -> str:
    """Beyond the limit of the input there is nothing; what is less than a count of it is 0."""
    inside = min(max(n, -one.largest), one.largest)
    value = inside / one.per_unit if abs(inside) >> one.shift else 0.0
    return f"{value:.4g} {one.signal.quantity.unit}"


def _then(section: FuzzySection, rule: Rule) -> str:
    """The current, and of a straight line what each of its signals adds."""
    term, *slopes = rule.conclusions
    parts = []
    if term is not None:
        parts.append(current_text(section.rules.outputs[0].values, term, 1e-3 / ONE_mA_Q8))
    for slope, output, number in zip(
        section.slopes, section.rules.outputs[1:], slopes, strict=True
    ):
        if number is not None and output.values and output.values[number]:
            one = section.inputs[slope.input]
            gain = 1e-3 * output.values[number] / ONE_mA_Q8 * one.per_unit / 2.0**slope.shift
            parts.append(f"{gain:+.4g} A per {one.signal.quantity.unit} of {slope.input + 1}")
    return " ".join(parts)
