"""The self-tuning fuzzy model on line (seed paper on the RD-1005-3, 3.3 and 4): over a change, and
over its 24 sines and chirps."""

import sys

from quiesce_benchmarks.papers import online_protocol
from quiesce_benchmarks.papers.online_changes import (
    CHANGES,
    SETTLE_s,
    followed,
    numbers_of,
    on_measured_damper,
    table_of,
    worst,
)
from quiesce_benchmarks.part import Effort, Measured

TITLE = "self-tuning fuzzy model on line, over changes of current, temperature and damper"
# Worst over the kinds of change, from 2 s after it on.
FIGURES = (
    ("online_error_after_change_pct", "%", None, "lower"),
    ("online_over_best_frozen", "1", 1.0, "lower"),
)


def measure(effort: Effort) -> Measured:
    changes = {}
    for kind, change in CHANGES.items():
        print(f"papers: online, {kind}", file=sys.stderr, flush=True)
        changes[kind] = numbers_of(followed(change, effort))
    measured = on_measured_damper(effort)
    print("papers: online, sines and chirps", file=sys.stderr, flush=True)
    protocol, protocol_table = online_protocol.measured(effort)
    return Measured(
        {
            "online_error_after_change_pct": worst(changes, "after_pct"),
            "online_over_best_frozen": worst(changes, "over_best_frozen"),
        },
        {
            "settle_s": SETTLE_s,
            "changes": changes,
            "measured_damper": measured,
            "protocol": protocol,
        },
        (table_of({**changes, **measured}), protocol_table),
    )
