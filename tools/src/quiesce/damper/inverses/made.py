"""Inverses made by several methods from one source."""

from collections.abc import Sequence
from dataclasses import dataclass
from time import monotonic

from quiesce.base.errors import UsageError
from quiesce.damper.inverses.compiled import compiled
from quiesce.damper.inverses.demand import Inverse, Source
from quiesce.damper.inverses.mapped import MapInverse
from quiesce.damper.inverses.methods import METHODS
from quiesce.damper.inverses.tracking import CONSTANT, IDEAL
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
        return METHODS[self.method].TRACKER

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


def check_names(names: Sequence[str]) -> None:
    """UsageError where two are the same, or one is that of a peer in a comparison."""
    for k, name in enumerate(names):
        if name in (CONSTANT, IDEAL, *names[:k]):
            raise UsageError(f"two inverses would be named '{name}'; leave one out")


def to_compare(inverses: Sequence[Made]) -> dict[str, Inverse]:
    """By name, compiled maps among them. UsageError from check_names."""
    pairs: list[tuple[str, Inverse]] = []
    for one in inverses:
        pairs.append((one.name, one.inverse))
        if one.own_map is not None:
            pairs.append((one.map_name, one.own_map))
    check_names([name for name, _ in pairs])
    return dict(pairs)
