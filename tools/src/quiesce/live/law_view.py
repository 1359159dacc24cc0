"""The law's table that a controller uses, fetched from it, as numbers of a picture: the surface of
its rules, or its pulses."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from quiesce.can.roads import LAW
from quiesce.can.services import Services
from quiesce.can.tables import Tables
from quiesce.rules.engine.engine import TableEngine
from quiesce.rules.integers.rule_words import read_rules
from quiesce.rules.surface.words import is_surface, read_surface
from quiesce.table.file import read_data
from quiesce.table.kinds import PULSES, RULES, kind_name
from quiesce.tune.phase_words import law_of_words

SIDE = 48  # points of each axis
DIGITS = 4  # of a number on its way to the page
BEYOND = 0.1  # of an axis, drawn on both sides of where anything happens
FREQ_Hz, ACCEL_m_s2, CURRENT_A = 1e-6, 1e-6, 1e-3  # of the controller's integers
View = dict[str, Any]


def view_of(data: bytes) -> View:
    """data: a table's file, as it is fetched. `kind`, `crc`, and `surface` or `pulses` where there
    is a picture of it. UsageError where this computer cannot compute it."""
    words = read_data(data).words
    view: View = {"kind": kind_name(words[0]), "crc": f"{words[1]:08x}"}
    if words[0] == RULES.magic:
        view["surface"] = surface_of(words)
    elif words[0] == PULSES.magic:
        view["pulses"] = pulses_of(words)
    return view


def surface_of(words: Sequence[int]) -> View:
    """current_A: of each acceleration a row over the frequencies."""
    if is_surface(words):
        ends = [(nodes[0], nodes[-1]) for nodes in read_surface(words).nodes]
    else:
        ends = [axis.ends for axis in read_rules(words).axes]
    freq, accel = (axis_of(low, high) for low, high in ends)
    grid = np.meshgrid(freq, accel)
    out, _ = TableEngine(words).evaluate([one.ravel().astype(np.int32) for one in grid])
    current_A = CURRENT_A * out[0].reshape(grid[0].shape)
    return {
        "freq_Hz": rounded(FREQ_Hz * freq),
        "accel_m_s2": rounded(ACCEL_m_s2 * accel),
        "current_A": [rounded(row) for row in current_A],
    }


def axis_of(low: int, high: int) -> np.ndarray:
    """Some more than from low to high; frequencies and accelerations are not below 0."""
    beyond = max(BEYOND * (high - low), SIDE)  # where nothing changes, too
    ends = np.clip([low - beyond, high + beyond], 0, 2**31 - 1)
    return np.rint(np.linspace(*ends, SIDE))


def pulses_of(words: Sequence[int]) -> View:
    """Of each setting rows of frequency, centre and width in degrees of half a cycle, level."""
    law = law_of_words(words)
    settings = {
        name: [
            rounded([one.freq_Hz, one.centre_deg, one.width_deg, CURRENT_A * one.level_mA])
            for one in points
        ]
        for name, points in law.settings.items()
    }
    return {"settings": settings, "unlock_A": CURRENT_A * law.unlock_current_mA}


def rounded(values: Sequence[float] | np.ndarray) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]


def look(keep: Callable[[View], None]) -> Callable[[Services], str]:
    """What the job does. BenchFailure where there is no table, or it does not come."""

    def work(services: Services) -> str:
        view = view_of(Tables(services.link, services.requests.database).fetch(LAW))
        keep(view)
        return f"{view['kind']} {view['crc']} is shown"

    return work
