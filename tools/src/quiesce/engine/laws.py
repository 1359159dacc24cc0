"""The control laws that `quiesce hil` compares, as settings of the bench."""

from dataclasses import dataclass

from quiesce.base.errors import UsageError
from quiesce.engine.params import parameters

OPEN_LOOP = "open_loop"
CONSTANT_BEST = "constant_best"


@dataclass(frozen=True)
class Law:
    name: str
    label: str
    bench_law: str
    settings: tuple[str, ...] = ()


LAWS = (
    Law(OPEN_LOOP, "open loop, 0 A", "off"),
    Law(CONSTANT_BEST, "best constant", "constant"),
    Law("fuzzy", "fuzzy", "fuzzy"),
    Law("phase", "phase, balanced", "phase", ("phase_setting=balanced",)),
    Law("phase_displacement", "phase, displacement", "phase", ("phase_setting=displacement",)),
    Law(
        "fuzzy_selftune_printed",
        "fuzzy + self-tuning",
        "fuzzy_selftune",
        (
            "selftune_rate_mA_s=200000",
            "selftune_polarity=1",
            "selftune_upper_mHz=100000",
            "selftune_leak_ms=0",
        ),
    ),
    Law(
        "fuzzy_selftune_reversed",
        "reversed self-tuning",
        "fuzzy_selftune",
        (
            "selftune_rate_mA_s=500000",
            "selftune_polarity=-1",
            "selftune_upper_mHz=7500",
            "selftune_leak_ms=0",
        ),
    ),
)


def names() -> list[str]:
    return [law.name for law in LAWS]


def labels() -> list[str]:
    """Of the firmware: one that was added is found."""
    return next(one["labels"] for one in parameters() if one["name"] == "law")


def find(name: str) -> Law:
    """One that is compared by default, or one of the firmware with its parameters as they are."""
    for law in LAWS:
        if law.name == name:
            return law
    if name in labels():
        return Law(name, name, name)
    known = ", ".join([*names(), *(label for label in labels() if label not in names())])
    raise UsageError(f"no law '{name}'; there are: {known}")
