"""Kinds of tables by their first word, and who works with them."""

from dataclasses import dataclass

LAW, TRACKER, LEARNT_ROAD = range(3)
ROADS = ("the law's table", "the tracker's table", "what was learnt")


@dataclass(frozen=True)
class Kind:
    """magic: kind and version. road: of ROADS. laws, trackers: values of parameters law and
    tracker that work with it."""

    name: str
    magic: int
    road: int
    laws: tuple[str, ...] = ()
    trackers: tuple[str, ...] = ()

    @property
    def version(self) -> str:
        """The last of the four letters that the first word is."""
        return chr(self.magic >> 24)


RULES = Kind("rules", 0x31545A46, LAW, ("fuzzy", "fuzzy_selftune"))
PULSES = Kind("pulses", 0x31485051, LAW, ("phase",))
LINEAR = Kind("linear", 0x314E4C51, LAW, ("linear",))
SIGNS = Kind("signs", 0x31475351, LAW, ("signs",))
FRICTION = Kind("friction", 0x31524651, LAW, ("friction",))
POLYNOMIAL = Kind("polynomial", 0x314C5051, LAW, ("polynomial",))
RULES_ON_SIGNALS = Kind("rules_on_signals", 0x31534651, LAW, ("fuzzy_signals",))
NETWORK = Kind("network", 0x314E4E51, LAW, ("network",))
MAP = Kind("map", 0x32464D51, TRACKER, trackers=("inverse",))
BANK = Kind("bank", 0x314B4251, TRACKER, trackers=("bank",))
INVERSE_NETWORK = Kind("inverse_network", 0x314E5451, TRACKER, trackers=("network",))
LEARNT = Kind("learnt", 0x31544C51, LEARNT_ROAD, ("phase",))

KINDS = {
    one.magic: one
    for one in (
        RULES, PULSES, LINEAR, SIGNS, FRICTION, POLYNOMIAL, RULES_ON_SIGNALS, NETWORK,
        MAP, BANK, INVERSE_NETWORK, LEARNT,
    )
}  # fmt: skip


def kind_name(magic: int) -> str:
    """0: none."""
    if magic == 0:
        return "none"
    return KINDS[magic].name if magic in KINDS else f"0x{magic:08x}"
