"""A compiled base as text for native/model.h: the rule file's real numbers, and the engines."""

from collections.abc import Sequence
from fractions import Fraction

from quiesce.rules.engine.engine import FUNCTION, straight_source
from quiesce.rules.integers.cells import INT32_MAX, INT32_MIN, Axis, ceil, floor
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.integers.emit import why_not_straight
from quiesce.rules.integers.table import METHOD, table_words
from quiesce.rules.model import CENTROID, OR, FuzzySet, Input, Output

SAMPLED_POINTS = 1 << 22  # of all inputs together, where not every integer is visited


def integer_range(compiled: CompiledBase, index: int) -> tuple[int, int]:
    """First and last integer inside the universe."""
    variable, axis = compiled.base.inputs[index], compiled.axes[index]
    return ceil(axis.position(variable.minimum)), floor(axis.position(variable.maximum))


def grid_points(compiled: CompiledBase) -> int:
    """All combinations of integers inside the universes."""
    count = 1
    for index in range(len(compiled.axes)):
        first, last = integer_range(compiled, index)
        count *= last - first + 1
    return count


def samples(compiled: CompiledBase, index: int) -> list[int]:
    """Both ends of every cell, their neighbours, int32's ends, and even steps between."""
    count = max(16, int(SAMPLED_POINTS ** (1 / len(compiled.axes))))
    first, last = integer_range(compiled, index)
    found = {INT32_MIN, INT32_MAX, first - 1, first, last, last + 1}
    for cell in compiled.cells[index]:
        found |= {cell.first, cell.first + 1, cell.last - 1, cell.last}
    steps = max(2, count - len(found))
    found |= {first + (last - first) * step // steps for step in range(steps + 1)}
    return sorted(n for n in found if INT32_MIN <= n <= INT32_MAX)


def model_text(compiled: CompiledBase) -> str:
    """model_values.h."""
    lines = [
        f"#define MODEL_INPUTS {len(compiled.base.inputs)}",
        f"#define MODEL_OUTPUTS {len(compiled.base.outputs)}",
        f"#define MODEL_RULES {len(compiled.base.rules)}",
    ]
    words = ", ".join(f"0x{word:08x}u" for word in table_words(compiled))
    lines.append(f"static const uint32_t model_words[] = {{{words}}};")
    lines.append(
        "static inline const fuzzy_table_t *model_table(void) "
        "{ return (const fuzzy_table_t *)(const void *)model_words; }"
    )
    if not why_not_straight(compiled):
        lines += [f"#define MODEL_STRAIGHT {FUNCTION}", straight_source(compiled)]
    lines += inputs_text(compiled)
    lines += outputs_text(compiled)
    lines += rules_text(compiled)
    return "\n".join(lines) + "\n"


def number(x: float | Fraction) -> str:
    return repr(float(x))


def set_lines(name: str, sets: Sequence[FuzzySet]) -> list[str]:
    lines = []
    for k, one in enumerate(sets):
        points = ", ".join(f"{{{number(x)}, {number(mu)}}}" for x, mu in one.points)
        lines.append(f"static const model_point_t {name}_{k}[] = {{{points}}};")
    rows = ", ".join(f"{{{len(one.points)}, {name}_{k}}}" for k, one in enumerate(sets))
    return [*lines, f"static const model_set_t {name}[] = {{{rows}}};"]


def axis_text(axis: Axis) -> str:
    return f"{number(axis.lsb.numerator)}, {number(axis.lsb.denominator)}"


def inputs_text(compiled: CompiledBase) -> list[str]:
    lines, rows = [], []
    for index, (variable, axis) in enumerate(zip(compiled.base.inputs, compiled.axes, strict=True)):
        lines += set_lines(f"input_{index}", variable.sets)
        places = samples(compiled, index)
        listed = ", ".join(map(str, places))
        lines.append(f"static const int64_t samples_{index}[] = {{{listed}}};")
        rows.append(input_row(compiled, index, variable, axis, len(places)))
    return [*lines, f"static const model_input_t model_inputs[] = {{{', '.join(rows)}}};"]


def input_row(compiled: CompiledBase, index: int, variable: Input, axis: Axis, sampled: int) -> str:
    first, last = integer_range(compiled, index)
    ends = f"{number(variable.minimum)}, {number(variable.maximum)}, {number(axis.origin)}"
    sets = f"{len(variable.sets)}, input_{index}"
    return f"{{{ends}, {axis_text(axis)}, {first}, {last}, {sets}, {sampled}, samples_{index}}}"


def outputs_text(compiled: CompiledBase) -> list[str]:
    lines, rows = [], []
    for index, output in enumerate(compiled.base.outputs):
        axis = compiled.outputs[index].axis
        kind = f"{METHOD[output.method]}, {len(output.terms)}"
        head = f"{number(axis.origin)}, {axis_text(axis)}, {kind}"
        if output.method == CENTROID:
            lines += set_lines(f"output_{index}", output.terms)
            places = breakpoints(output)
            listed = ", ".join(map(number, places))
            lines.append(f"static const double breakpoints_{index}[] = {{{listed}}};")
            rows.append(f"{{{head}, 0, output_{index}, {len(places)}, breakpoints_{index}}}")
        else:
            listed = ", ".join(number(term.value) for term in output.terms)
            lines.append(f"static const double singletons_{index}[] = {{{listed}}};")
            rows.append(f"{{{head}, singletons_{index}, 0, 0, 0}}")
    return [*lines, f"static const model_output_t model_outputs[] = {{{', '.join(rows)}}};"]


def breakpoints(output: Output) -> list[float]:
    inside = {output.minimum, output.maximum}
    for term in output.terms:
        inside |= {x for x, _ in term.points if output.minimum < x < output.maximum}
    return sorted(inside)


def rules_text(compiled: CompiledBase) -> list[str]:
    rows = []
    for rule in compiled.base.rules:
        conditions = ", ".join(
            f"{{{c.input}, {c.set}, {str(c.negated).lower()}}}" for c in rule.conditions
        )
        conclusions = ", ".join("-1" if t is None else str(t) for t in rule.conclusions)
        rows.append(
            f"{{{str(rule.connective == OR).lower()}, {len(rule.conditions)}, {{{conditions}}}, "
            f"{{{conclusions}}}, {number(rule.weight)}}}"
        )
    return [f"static const model_rule_t model_rules[] = {{{', '.join(rows)}}};"]
