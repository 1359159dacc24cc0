"""The steps in their order: each has NAME, TITLE, run(work) -> its result, which JSON can hold, and
line(result), what it came to."""

from types import ModuleType

from quiesce.commission.steps import (
    calibrate,
    damper,
    excite,
    find,
    load,
    report,
    tune,
    verify,
    wiring,
)

STEPS: tuple[ModuleType, ...] = (
    wiring, calibrate, excite, find, damper, tune, load, verify, report,
)  # fmt: skip
NAMES = tuple(one.NAME for one in STEPS)
