"""Reads T2FIS, the files of the open IT2-FLS Toolbox for MATLAB: Sugeno systems whose inputs have
interval type-2 sets, each an upper and a lower one.

With Nie and Tan's reduction such a system is one of type 1: each rule is there twice, once with the
upper and once with the lower sets, and the average is over all of them. `not` makes the upper end
of the lower set, and the other way round. An interval of a conclusion counts with its middle.
"""

import re
from dataclasses import replace

import numpy as np

from quiesce.rules.formats.build import Builder, Content, Options, Term, Variable
from quiesce.rules.formats.fis import SYSTEM_KEYS, FisReader
from quiesce.rules.formats.logic import Draft, uses
from quiesce.rules.formats.scan import STRING, Source, Stream, Token
from quiesce.rules.model import AND, OR
from quiesce.rules.system.karnik_mendel import karnik_mendel, nie_tan
from quiesce.rules.system.model import Expression, Join, Proposition, System
from quiesce.rules.system.norms import NOT
from quiesce.rules.system.reference import fired_at, membership

NIE_TAN = ("NT", "Nie-Tan")
KARNIK_MENDEL = ("Karnik-Mendel", "KM", "EKM", "IASC", "EIASC", "EODS")  # ways to one answer
SIDES = ("U", "L")
UPPER, LOWER = 0, 1
COMPARED_POINTS = 20_000  # of all inputs together, about
COMPARED_AT_ONCE = 1_000
LOOKED_AT = 2_001  # places of an input
ALIKE = 1e-9  # of a membership


def read_t2fis(source: Source, name: str, options: Options) -> tuple[Builder, str, Token]:
    """As read_fis."""
    return Type2Reader(source, options).read(name)


class Type2Reader(FisReader):
    of_system = (*SYSTEM_KEYS, "TypeRedMethod", "outputType")
    of_output = ("CrispInterval",)
    is_term = re.compile("MF[0-9]+[UL]?")

    def __init__(self, source: Source, options: Options) -> None:
        super().__init__(source, options)
        self.reduction: Token | None = None
        # [output][term]: slopes and the constant of the left end and of the right one.
        self.ends: list[list[np.ndarray]] = []

    def read(self, name: str) -> tuple[Builder, str, Token]:
        builder, title, at = super().read(name)
        system = builder.system(title, at)
        self.check_reduction(system, at)
        self.note_order(system)
        self.note_toolbox()
        return builder, title, at

    def system_text(self, key: str, token: Token) -> None:
        if key == "TypeRedMethod":
            self.reduction = token
        elif key != "outputType":
            super().system_text(key, token)
        if key == "Type":
            if token.text != "sugeno":
                what = f"Type {token.shown()} of a type-2 file"
                raise self.source.error(token, what, "'sugeno'")
            self.builder.not_plain(token, "sets of type 2", "sets of type 1")
        if key == "DefuzzMethod" and token.text != "wtaver":
            raise self.source.error(token, f"DefuzzMethod {token.shown()}", "'wtaver'")

    def others(self, variable: Variable, entries: dict[str, Stream]) -> None:
        if "CrispInterval" in entries:
            self.text(entries["CrispInterval"], "'crisp' or 'interval'")
            self.finish_line(entries.pop("CrispInterval"))
        super().others(variable, entries)

    # ---- terms ----------------------------------------------------------------------------------

    def sides(self, variable: Variable) -> tuple[str, ...]:
        return SIDES if variable.is_input else ("",)

    def term(self, variable: Variable, stream: Stream) -> None:
        """A lower set that has the name of its upper one is told from it by an L."""
        super().term(variable, self.with_own_name(variable, stream))

    def with_own_name(self, variable: Variable, stream: Stream) -> Stream:
        terms, name = variable.terms, stream.token
        is_lower = variable.is_input and len(terms) % len(SIDES) == LOWER
        if not is_lower or name.kind != STRING or name.text[1:-1] != terms[-1].name.text:
            return stream
        upper = terms[-1]
        taken = Token(STRING, upper.name.text + SIDES[UPPER], upper.name.offset)
        terms[-1] = Term(taken, upper.at, upper.content)
        named = Token(STRING, f"{name.text[:-1]}{SIDES[LOWER]}{name.text[-1]}", name.offset)
        return Stream(self.source, [named, *stream.tokens[stream.at + 1 :]])

    def content(self, variable: Variable, at: Token, stream: Stream) -> Content:
        if not variable.is_input:
            return self.conclusion(variable, at, stream)
        shape = self.shape_of(at, ())
        *values, height = self.vector(stream, shape.parameters + 1)
        if not 0 < height <= 1:
            raise self.source.error(at, f"height {height:g} of {at.text}", "above 0, at most 1")
        return self.builder.shape(at, shape, values, height)

    def conclusion(self, variable: Variable, at: Token, stream: Stream) -> Content:
        """`constant` or `linear`: one, or a left and a right end."""
        inputs = len(self.builder.of_kind(is_input=True))
        counts = {"constant": 1, "linear": inputs + 1}
        if at.text not in counts:
            raise self.source.error(at, f"membership function {at.shown()}", " or ".join(counts))
        count, values = counts[at.text], self.numbers(stream)
        if len(values) not in (count, 2 * count):
            what = f"{len(values)} numbers of {at.text}"
            raise self.source.error(at, what, f"{count}, or {2 * count} for two ends")
        ends = np.zeros((2, inputs + 1))
        ends[:, -count:] = np.reshape(values * (2 * count // len(values)), (2, count))
        outputs = len(self.builder.of_kind(is_input=False))
        self.ends += [[] for _ in range(outputs - len(self.ends))]
        self.ends[-1].append(ends)
        return self.builder.linear(at, ends.mean(axis=0).tolist())

    def numbers(self, stream: Stream) -> list[float]:
        """`[a b ...]`; one may stand bare."""
        return self.values(stream)[0] if stream.sees("[") else self.vector(stream, 1)

    # ---- rules ----------------------------------------------------------------------------------

    def index(self, stream: Stream, variable: Variable) -> tuple[int, tuple[str, ...]]:
        """The number of a term is that of its pair: here its upper set, which a condition keeps."""
        if not variable.is_input:
            return super().index(stream, variable)
        pairs = replace(variable, terms=variable.terms[:: len(SIDES)])
        return super().index(stream, pairs)

    def drafts(self, tokens: list[Token]) -> list[Draft]:
        draft = self.rule(tokens)
        ends = (self.end(draft.expression, side) for side in (UPPER, LOWER))
        return [replace(draft, expression=end) for end in ends]

    def end(self, expression: Expression, side: int) -> Expression:
        """With the sets that make this end of its interval."""
        if isinstance(expression, Join):
            parts = tuple(self.end(part, side) for part in expression.parts)
            return replace(expression, parts=parts)
        assert isinstance(expression, Proposition)
        is_other = NOT in expression.hedges
        own = 1 - side if is_other else side
        return replace(expression, term=len(SIDES) * expression.term + own)

    # ---- what the file asks for -----------------------------------------------------------------

    def check_reduction(self, system: System, at: Token) -> None:
        token, expected = self.reduction, "'NT', Nie and Tan's, the one that is computed"
        if token is not None and token.text in NIE_TAN:
            return
        if token is not None and token.text not in KARNIK_MENDEL:
            raise self.source.error(token, f"TypeRedMethod {token.shown()}", expected)
        named = token.shown() if token else "missing, which is Karnik and Mendel's"
        raise self.source.error(
            token or at,
            f"TypeRedMethod {named}",
            f"{expected}: with these sets at most {100 * self.furthest(system):.2g} % of the range "
            "from Karnik and Mendel's; write TypeRedMethod='NT' where that will do",
        )

    def furthest(self, system: System) -> float:
        """The largest difference of Karnik and Mendel's answers from Nie and Tan's, as a part of an
        output's range."""
        steps = max(3, round(COMPARED_POINTS ** (1 / len(system.inputs))))
        axes = [np.linspace(one.minimum, one.maximum, steps) for one in system.inputs]
        points = np.stack([axis.ravel() for axis in np.meshgrid(*axes)])
        parts = range(0, points.shape[1], COMPARED_AT_ONCE)
        return max(self.furthest_of(system, points[:, i : i + COMPARED_AT_ONCE]) for i in parts)

    def furthest_of(self, system: System, points: np.ndarray) -> float:
        """points: [input, point]."""
        strengths = fired_at(system, list(points))[1]
        inputs = np.concatenate([points, np.ones((1, points.shape[1]))])
        found = 0.0
        for index, output in enumerate(system.outputs):
            rules = [
                (number, one.term)
                for number, rule in enumerate(system.rules)
                for one in rule.conclusions
                if one.output == index
            ]
            if not rules:
                continue
            fired = strengths[[number for number, _ in rules]]
            both = np.stack([fired[LOWER::2], fired[UPPER::2]])
            ends = np.stack([self.ends[index][term] for _, term in rules[::2]], axis=1)
            values = np.sort(ends @ inputs, axis=0)
            apart = np.abs(karnik_mendel(both, values) - nie_tan(both, values))
            worst = float(np.nanmax(apart, initial=0.0))
            found = max(found, worst / (output.maximum - output.minimum))
        return found

    def note_order(self, system: System) -> None:
        for one in system.inputs:
            x = np.linspace(one.minimum, one.maximum, LOOKED_AT)
            for upper, lower in zip(one.terms[::2], one.terms[1::2], strict=True):
                above = membership(lower.curve, x) - membership(upper.curve, x)
                worst = int(np.argmax(above))
                if above[worst] > ALIKE:
                    self.builder.notes.append(
                        f"input {one.name}: the lower set {lower.name} is above its upper one by "
                        f"{above[worst]:.3g} at {x[worst]:.4g}; both count alike"
                    )

    def note_toolbox(self) -> None:
        """Where the toolbox's own evaluation does not do what the file says."""
        drafts = self.builder.drafts
        all_conditions = [one for d in drafts for one in conditions(d.expression)]
        conjunction = self.methods.get("AndMethod")
        says_other = conjunction is None or conjunction.text != "prod"
        found = [
            *(["AND"] if says_other and any(uses(d.expression, AND) for d in drafts) else []),
            *(["OR"] if any(uses(d.expression, OR) for d in drafts) else []),
            *(["not"] if any(NOT in one.hedges for one in all_conditions) else []),
            *(["weights"] if any(d.weight != 1 for d in drafts) else []),
        ]
        if found:
            self.builder.notes.append(
                f"{', '.join(found)}: computed as the file says; the IT2-FLS Toolbox itself "
                "multiplies all memberships, divides by those of a negated term and takes no weight"
            )


def conditions(expression: Expression) -> list[Proposition]:
    if isinstance(expression, Join):
        return [one for part in expression.parts for one in conditions(part)]
    assert isinstance(expression, Proposition)
    return [expression]
