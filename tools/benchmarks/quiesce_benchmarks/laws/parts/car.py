"""A quarter of a car on a C road at 72 km/h."""

import tempfile
from pathlib import Path

from quiesce.compare.roads import road
from quiesce.compare.run import Shaking
from quiesce.compare.table import means, text

from quiesce_benchmarks.laws import rigs
from quiesce_benchmarks.part import Effort, Measured

TITLE = "car: comfort and the tyre's load"
FIGURES = (
    ("quarter_car_tyre", "of its load at rest", 0.215, "lower"),
    ("quarter_car_comfort_m_s2", "m/s2", None, "lower"),
)
SPEED_km_h = 72.0
# Held to the road and the sky at once, by a map of the damper; found by 60 trials on this road.
MIXED = {"sky_N_s_m": 2500.0, "ground_N_s_m": 2500.0, "between_N_s_m": 2300.0}
DAMPER, MOST_A = "rd1005_kwok_tanh_smooth", 1.88
CANDIDATES = {
    "skyhook on off": ("skyhook_on_off", {}),
    "skyhook on off, base 0.5 A": ("skyhook_on_off", {"off_A": 0.5}),
    "groundhook on off": ("groundhook_on_off", {}),
    "groundhook on off, base 0.5 A": ("groundhook_on_off", {"off_A": 0.5}),
    "SH-ADD": ("sh_add", {}),
    "ADD": ("add", {}),
}


def measure(effort: Effort) -> Measured:
    on = rigs.comparison(rigs.CAR, Shaking())
    with tempfile.TemporaryDirectory(prefix="quiesce-laws-") as name:
        laws = [
            rigs.compared(Path(name), label, rigs.made(rigs.CAR, recipe, settings))
            for label, (recipe, settings) in CANDIDATES.items()
        ]
        of_damper = rigs.map_of(Path(name), DAMPER, MOST_A)
        for label, recipe, settings in (
            ("mixed", "mixed_hooks", MIXED),
            ("skyhook", "skyhook", {}),
        ):
            table = rigs.made(rigs.CAR, recipe, settings)
            laws.append(rigs.compared(Path(name), label, table, map_file=of_damper))
        cells = on.cells(laws, [road("C", SPEED_km_h)], [effort.seed])
    found = {law.label: means(cells, law.label) for law in laws}
    values: dict[str, float | None] = {
        "quarter_car_tyre": min(one["tyre_share"] for one in found.values()),
        "quarter_car_comfort_m_s2": min(one["weighted_m_s2"] for one in found.values()),
    }
    return Measured(values, tables=(text(cells),))
