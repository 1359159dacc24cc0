"""A rule base as text for the terminal: what it has, its rules as a matrix or a list."""

from collections.abc import Sequence

from quiesce.base.table import format_table
from quiesce.rules.model import AND, Rule, RuleBase, Singleton
from quiesce.rules.system.model import ConstantTerm
from quiesce.rules.views.subject import AnyOutput, Subject, rule_line, terms_of
from quiesce.rules.views.visits import Fired, Visits


def plural(count: int, word: str) -> str:
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def summary(base: Subject) -> str:
    counts = (
        plural(len(base.inputs), "input"),
        plural(len(base.outputs), "output"),
        plural(len(base.rules), "rule"),
    )
    rows = [
        ["input", v.name, f"{v.minimum:g} .. {v.maximum:g}", ", ".join(s.name for s in terms_of(v))]
        for v in base.inputs
    ]
    rows += [
        ["output", o.name, f"{o.minimum:g} .. {o.maximum:g}", output_text(o)] for o in base.outputs
    ]
    table = format_table(["", "name", "universe", "sets"], rows, left=(0, 1, 2, 3))
    return f"{base.name}: {', '.join(counts)}\n\n{table}"


def output_text(output: AnyOutput) -> str:
    terms = ", ".join(
        f"{term.name} {term.value:g}" if isinstance(term, Singleton | ConstantTerm) else term.name
        for term in output.terms
    )
    default = "no default" if output.default is None else f"default {output.default:g}"
    return f"{terms}; {output.method}; {default}"


def fits_matrix(base: RuleBase, rule: Rule) -> bool:
    inputs = {condition.input for condition in rule.conditions}
    is_plain = rule.connective == AND and not any(c.negated for c in rule.conditions)
    return len(base.inputs) == 2 and is_plain and len(rule.conditions) == 2 and len(inputs) == 2


def conclusion(base: RuleBase, rule: Rule) -> str:
    terms = ",".join(
        "-" if term is None else output.terms[term].name
        for output, term in zip(base.outputs, rule.conclusions, strict=True)
    )
    return terms if rule.weight == 1 else f"{terms}*{rule.weight:g}"


def matrix(base: RuleBase) -> str:
    """Of the rules `first IS .. AND second IS ..`: a row for each set of the first input."""
    rows_of, columns_of = base.inputs
    cells = [["" for _ in columns_of.sets] for _ in rows_of.sets]
    for rule in base.rules:
        if fits_matrix(base, rule):
            row, column = (c.set for c in sorted(rule.conditions, key=lambda c: c.input))
            before = cells[row][column]
            cells[row][column] = f"{before}/{conclusion(base, rule)}".lstrip("/")
    head = [f"{rows_of.name} \\ {columns_of.name}", *(one.name for one in columns_of.sets)]
    rows = [
        [one.name, *(cell or "." for cell in row)]
        for one, row in zip(rows_of.sets, cells, strict=True)
    ]
    return format_table(head, rows, left=range(len(head)))


def rule_list(base: Subject, indices: Sequence[int]) -> str:
    return "\n".join(f"{i + 1:>4}  {rule_line(base, i)}" for i in indices)


def rules_text(base: Subject) -> str:
    """A matrix where rules fit into one, a list of the others."""
    others = [
        i
        for i, rule in enumerate(base.rules)
        if not (isinstance(base, RuleBase) and fits_matrix(base, rule))
    ]
    if len(others) == len(base.rules):
        return rule_list(base, others)
    assert isinstance(base, RuleBase)
    names = ", ".join(output.name for output in base.outputs)
    parts = [f"{names} by {base.inputs[0].name} (rows) and {base.inputs[1].name} (columns)", ""]
    parts.append(matrix(base))
    if others:
        parts += ["", "and", rule_list(base, others)]
    return "\n".join(parts)


def visits_text(base: Subject, visits: Visits) -> str:
    counted = visits.inputs.shape[1]
    rows = f"{counted} rows" if counted == visits.rows else f"{counted} of {visits.rows} rows"
    condition = f" ({visits.condition})" if visits.condition else ""
    ranges = ", ".join(
        f"{variable.name} {values.min():.4g} .. {values.max():.4g}"
        for variable, values in zip(base.inputs, visits.inputs, strict=True)
    )
    return f"visited in {visits.name}, {rows}{condition}: {ranges}"


def fired_text(base: Subject, fired: Sequence[Fired]) -> str:
    """The rules that fired, most often first."""
    order = sorted(range(len(fired)), key=lambda i: (-fired[i].share, -fired[i].strongest, i))
    rows = [
        (
            i + 1,
            rule_line(base, i),
            100 * one.share,
            100 * one.strongest,
            one.mean_strength,
        )
        for i in order
        if (one := fired[i]).share > 0
    ]
    if not rows:
        return "no rule fired"
    head = ["rule", "", "fired||.1f %", "strongest||.1f %", "mean strength||.3f"]
    silent = len(fired) - len(rows)
    note = f"\n{plural(silent, 'rule')} never fired" if silent else ""
    return format_table(head, rows, left=(1,)) + note
