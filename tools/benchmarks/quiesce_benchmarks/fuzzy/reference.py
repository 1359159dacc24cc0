"""The reference controller of the fuzzy benchmark (tools/benchmarks/rules) in all forms that are
measured.

Frequency and RMS acceleration of a vibration to a current: four sets each, sixteen rules. Its
singletons are averaged in both ways that peers know, sum over rules and maximum per term.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from quiesce.base.paths import root
from quiesce.rules.formats.files import read_rules
from quiesce.rules.integers.compile import compile_base
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.model import WEIGHTED_MAX, WEIGHTED_SUM, RuleBase

SUM, MAX, CENTROID = "sum", "max", "centroid"
METHODS = (SUM, MAX, CENTROID)
SINGLETON_METHODS = (SUM, MAX)

# Integers of the inputs, of the output: shares of the universes, or uHz and um/s2, as the firmware
# has them, and 1/65536 of the output's universe.
Q15, PHYSICAL = "q15", "physical"
FORMATS: dict[str, tuple[str | Sequence[str], str]] = {
    Q15: ("q15", "q16"),
    PHYSICAL: (["1e-6", "1e-6"], "q16"),
}


@dataclass(frozen=True)
class Variant:
    """One base in one format. name: of its C functions, reference_METHOD_FORMAT."""

    method: str
    format: str

    @property
    def name(self) -> str:
        return f"reference_{self.method}_{self.format}"


VARIANTS = tuple(Variant(method, form) for method in METHODS for form in FORMATS)


def reference_base(method: str) -> RuleBase:
    if method == CENTROID:
        return read_rules(root() / "tools/benchmarks/rules/reference_centroid.fcl")
    base = read_rules(root() / "tools/benchmarks/rules/reference_singleton.fcl")
    wanted = WEIGHTED_SUM if method == SUM else WEIGHTED_MAX
    return replace(base, outputs=tuple(replace(one, method=wanted) for one in base.outputs))


def compiled(variant: Variant) -> CompiledBase:
    return compile_base(reference_base(variant.method), *FORMATS[variant.format])
