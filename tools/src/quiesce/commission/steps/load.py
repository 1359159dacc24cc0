"""Pulses and parameters into the controller, checked by it, kept where it has a memory."""

import shutil
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.can.changes import save as save_parameters
from quiesce.commission.simulated import TABLE
from quiesce.commission.work import TUNED, Work
from quiesce.loading.load import put, save
from quiesce.loading.sources import table_of
from quiesce.table.file import SUFFIX
from quiesce.table.kinds import PULSES

NAME = "load"
TITLE = "load"
LAG = "current_lag_ms"
CURRENTS = {"max_current_mA", "unlock_current_mA", "constant_current_mA", "narrow_current_mA"}


def run(work: Work) -> dict[str, Any]:
    folder = work.path / TUNED
    table = table_of(PULSES.name, folder)
    has_lag = work.result("wiring").get("lag_s") is not None
    settings = limited(work.result("tune")["parameters"], work.site.limit_mA, has_lag)
    work.give(settings)
    tables = work.site.rig.tables()
    try:
        took_s = put(tables, table, work.tell)
    except BenchFailure as error:  # law phase has to be there first: others refuse pulses
        raise BenchFailure(
            f"pulses: {error}; the parameters that go with them are in effect already, not kept "
            "for the next start"
        )
    is_saved = not work.site.is_simulated  # one in the computer keeps nothing
    if is_saved:
        save(tables, table)
        save_parameters(tables.services)
    made = sorted(folder.glob(f"*.phase{SUFFIX}"))
    if len(made) != 1:
        raise BenchFailure(f"{folder}: {len(made)} tables; expected the one that was loaded")
    shutil.copyfile(made[0], work.path / TABLE)
    return {"crc": f"{table.crc:08x}", "took_s": took_s, "is_saved": is_saved}


def limited(parameters: dict[str, int | str], limit_mA: int, has_lag: bool) -> dict[str, int | str]:
    """No current above the limit. has_lag: that of the coil was measured, and given, in step
    wiring; else it is the plant's (a controller with a board file goes by that)."""
    out = {name: one for name, one in parameters.items() if name != LAG or not has_lag}
    for name in CURRENTS & out.keys():
        out[name] = min(int(out[name]), limit_mA)
    return out


def line(result: dict[str, Any]) -> str:
    kept = "kept for the next start" if result["is_saved"] else "not kept: it has no memory"
    return f"pulses {result['crc']} in use, checked by the controller; {kept}"
