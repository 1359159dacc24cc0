"""Inverses made by several methods from one source."""

from collections.abc import Sequence
from dataclasses import dataclass
from time import monotonic

from quiesce.damper.inverses.compiled import compiled, tracker_text
from quiesce.damper.inverses.demand import Inverse, Source
from quiesce.damper.inverses.mapped import MapInverse
from quiesce.damper.inverses.methods import METHODS
from quiesce.damper.learned.model import Report, silent


@dataclass(frozen=True)
class Made:
    """own_map: what tracker `inverse` reads in its place; None where there is none, or where it is
    one."""

    method: str
    name: str  # method, or the file that it was read from
    inverse: Inverse
    own_map: MapInverse | None
    seconds: float  # to make it; 0 for one from a file

    @property
    def tracker(self) -> str:
        return tracker_text(self.inverse)

    @property
    def map_name(self) -> str:
        return f"{self.name} as map"


def made(
    source: Source, methods: Sequence[str], seed: int, progress: Report = silent
) -> list[Made]:
    out = []
    for method in methods:
        start_s = monotonic()
        inverse = METHODS[method].make(source, seed, progress)
        out.append(Made(method, method, inverse, compiled(inverse), monotonic() - start_s))
    return out


def from_file(method: str, name: str, inverse: Inverse) -> Made:
    return Made(method, name, inverse, compiled(inverse), 0.0)


def to_compare(inverses: Sequence[Made]) -> dict[str, Inverse]:
    """By name, compiled maps among them."""
    out: dict[str, Inverse] = {}
    for one in inverses:
        out[one.name] = one.inverse
        if one.own_map is not None:
            out[one.map_name] = one.own_map
    return out
