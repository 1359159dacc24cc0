"""Tsukamoto's values as functions of an input, where a rule looks at one input only.

Such a value is the x at which a shape reaches the rule's strength: near the shape's ends it turns
on the last digits of the strength, which integers do not have, and it may grow beyond all bounds
there. Its product with the strength, which is what counts, does not, and as a function of the input
itself it is as smooth as the rule.
"""

from dataclasses import replace

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.system.model import (
    BY_RULE,
    BY_TERM,
    MAX_VALUES,
    Complement,
    Conclusion,
    ConstantTerm,
    Curve,
    Expression,
    FormulaTerm,
    ProductTerm,
    Proposition,
    StrengthTerm,
    System,
    SystemOutput,
    SystemRule,
)
from quiesce.rules.system.norms import ANY, UNBOUNDED_SUM
from quiesce.rules.system.reference import concluded, strength_of

MAX_SUMMED = 4  # strengths of a term, which hold up to 4 together


def folded(system: System) -> System:
    """The same answers; the reference is of the system as it was."""
    outputs = list(system.outputs)
    rules = list(system.rules)
    for index, output in enumerate(system.outputs):
        has_any = any(isinstance(term, StrengthTerm) for term in output.terms)
        if not has_any or is_named(system, index):
            continue
        if output.method == BY_TERM and is_concluded_once(system, index):
            output = replace(output, method=BY_RULE)  # the same
        if output.method != BY_TERM:
            outputs[index] = fold_output(system, index, output, rules)
    return replace(system, outputs=tuple(outputs), rules=tuple(rules))


def fold_output(
    system: System, index: int, output: SystemOutput, rules: list[SystemRule]
) -> SystemOutput:
    """Its terms with those that rules have of their own; the rules name them."""
    terms = list(output.terms)
    for number, rule in enumerate(rules):
        for place, conclusion in enumerate(rule.conclusions):
            term = output.terms[conclusion.term] if conclusion.output == index else None
            only = only_input(rule.expression)
            if not isinstance(term, StrengthTerm) or only is None or len(terms) >= MAX_VALUES:
                continue
            terms.append(product_of(system, rule, conclusion, term, only))
            own = replace(conclusion, term=len(terms) - 1)
            others = rule.conclusions
            rule = replace(rule, conclusions=(*others[:place], own, *others[place + 1 :]))
        rules[number] = rule
    used = {one.term for rule in rules for one in rule.conclusions if one.output == index}
    kept = [
        term if k in used else ConstantTerm(term.name, output.minimum)
        for k, term in enumerate(terms)
    ]
    return replace(output, terms=tuple(kept))


def product_of(
    system: System, rule: SystemRule, conclusion: Conclusion, term: StrengthTerm, only: int
) -> ProductTerm:
    used = [one for one in propositions(rule.expression) if one.is_input]
    curves = [system.inputs[only].terms[one.term].curve for one in used]
    knots = {x for one in curves for x in (*one.knots, *(x for x, _ in one.points or ()))}

    def strength(x: np.ndarray) -> np.ndarray:
        columns = [x if i == only else np.zeros_like(x) for i in range(len(system.inputs))]
        found = rule.weight * strength_of(system, rule, rule.expression, columns, [])
        return concluded(conclusion, found)

    def product(x: np.ndarray) -> np.ndarray:
        own = strength(x)
        return own * term.curve.function(own)

    curve = Curve(term.curve.word, product, None, tuple(sorted(knots)))
    return ProductTerm(term.name, only, curve, strength)


def propositions(expression: Expression) -> list[Proposition]:
    if isinstance(expression, Proposition):
        return [expression]
    parts = (expression.part,) if isinstance(expression, Complement) else expression.parts
    return [one for part in parts for one in propositions(part)]


def only_input(expression: Expression) -> int | None:
    """The input that it looks at, where that is one and nothing else."""
    found = [one for one in propositions(expression) if ANY not in one.hedges]
    variables = {one.variable for one in found}
    is_one = len(variables) == 1 and all(one.is_input for one in found)
    return variables.pop() if is_one else None


def is_concluded_once(system: System, output: int) -> bool:
    """Whether no two rules conclude the same term."""
    terms = [one.term for rule in system.rules for one in rule.conclusions if one.output == output]
    return len(terms) == len(set(terms))


def is_named(system: System, output: int) -> bool:
    """Whether some condition names an output."""
    return any(
        not one.is_input and one.variable == output
        for rule in system.rules
        for one in propositions(rule.expression)
    )


def deferred(system: System) -> System:
    """The same answers, with outputs whose terms name other outputs weighed term by term: that is
    done when those are known, not when a rule fires. UsageError where that is not the same."""
    outputs = tuple(
        deferred_output(system, i) if names_outputs(one) else one
        for i, one in enumerate(system.outputs)
    )
    return replace(system, outputs=outputs)


def names_outputs(output: SystemOutput) -> bool:
    return any(isinstance(term, FormulaTerm) and term.outputs for term in output.terms)


def deferred_output(system: System, index: int) -> SystemOutput:
    output = system.outputs[index]
    if output.method == BY_TERM:
        return output
    of = f"output {output.name}, whose terms name other outputs"
    if output.method != BY_RULE or any(
        isinstance(term, StrengthTerm | ProductTerm) for term in output.terms
    ):
        raise UsageError(f"{of}: only a weighted average of constants and formulas can")
    terms = [c.term for rule in system.rules for c in rule.conclusions if c.output == index]
    if any(terms.count(one) > MAX_SUMMED for one in terms) or is_named(system, index):
        raise UsageError(f"{of}: at most {MAX_SUMMED} rules a term, and no condition on it")
    return replace(output, method=BY_TERM, aggregation=UNBOUNDED_SUM)
