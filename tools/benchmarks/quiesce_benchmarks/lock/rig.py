"""The phase law on the published plant: what the parts that close the loop have in common."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from quiesce.base.paths import root
from quiesce.engine.bench import Bench

from quiesce_benchmarks.control.rig import Rig, make_judged, read_plant
from quiesce_benchmarks.part import Effort

# As `quiesce tune` says of this plant.
NARROW = [
    "narrow_current_mA=500",
    "narrow_low_mHz=3200",
    "narrow_high_mHz=6750",
    "narrow_least_um_s2=19822",
]
PLANT = "sim_hil/data/plants/squeeze_2012.toml"


@contextmanager
def phase_rig(effort: Effort) -> Iterator[Rig]:
    bench = Bench()
    plant = read_plant(bench, root() / PLANT)
    judged, params = make_judged(bench, "phase", NARROW, plant)
    with TemporaryDirectory() as scratch:
        yield Rig(bench, plant, judged, params, effort.seed, Path(scratch))
