"""Kinds of tables by their first word: what they are called, which road of the controller they take
and who works with them."""

from dataclasses import dataclass

LAW, TRACKER, LEARNT = "law", "tracker", "learnt"
ROADS = (LAW, TRACKER, LEARNT)  # by number


@dataclass(frozen=True)
class Kind:
    name: str
    magic: int
    road: str
    users: tuple[str, ...]  # labels of parameter law, or tracker

    @property
    def number(self) -> int:
        return ROADS.index(self.road)


KINDS = (
    Kind("rules", 0x31545A46, LAW, ("fuzzy", "fuzzy_selftune")),
    Kind("pulses", 0x31485051, LAW, ("phase",)),
    Kind("linear", 0x314E4C51, LAW, ("linear",)),
    Kind("signs", 0x31475351, LAW, ("signs",)),
    Kind("friction", 0x31524651, LAW, ("friction",)),
    Kind("polynomial", 0x314C5051, LAW, ("polynomial",)),
    Kind("rules_on_signals", 0x31534651, LAW, ("fuzzy_signals",)),
    Kind("network", 0x314E4E51, LAW, ("network",)),
    Kind("map", 0x32464D51, TRACKER, ("inverse",)),
    Kind("bank", 0x314B4251, TRACKER, ("bank",)),
    Kind("inverse_network", 0x314E5451, TRACKER, ("network",)),
    Kind("learnt", 0x31444151, LEARNT, ("phase",)),
)
BY_MAGIC = {kind.magic: kind for kind in KINDS}


def name_of(magic: int) -> str:
    """0: none."""
    if magic == 0:
        return "none"
    return BY_MAGIC[magic].name if magic in BY_MAGIC else f"0x{magic:08x}"


def users_text(kind: Kind) -> str:
    what = TRACKER if kind.road == TRACKER else LAW
    return f"{what} {' or '.join(kind.users)}"
