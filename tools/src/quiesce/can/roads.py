"""What `quiesce can` calls the roads of tables and the kinds on them, and who works with a kind."""

from quiesce.table import kinds
from quiesce.table.kinds import Kind

LAW, TRACKER, LEARNT = ROADS = ("law", "tracker", "learnt")  # by the number of a kind's road


def road_of(kind: Kind) -> str:
    return ROADS[kind.road]


def chooser_of(kind: Kind) -> str:
    """The parameter that chooses who works with it."""
    return TRACKER if kind.road == kinds.TRACKER else LAW


def users_of(kind: Kind) -> tuple[str, ...]:
    """Values of that parameter."""
    return kind.trackers if kind.road == kinds.TRACKER else kind.laws
