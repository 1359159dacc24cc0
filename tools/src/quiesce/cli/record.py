"""`quiesce record SCENARIO`: what the simulated sensors measured, as a recording."""

import argparse
import tempfile
from pathlib import Path

import numpy as np

from quiesce.base.atomic import output_files
from quiesce.base.command import finite_number
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.engine import laws, scenarios
from quiesce.engine.bench import Bench, setting_options
from quiesce.engine.trace import Trace, read_trace
from quiesce.recording.write import require_writer, time_text, write_columns
from quiesce.signal.recording import COLUMN_UNITS, M_S2_PER_UNIT

EPILOG = """examples:
  quiesce record step_10_20Hz --from-s 2 --to-s 8 --out step.csv
  quiesce record sine_5Hz --law fuzzy --out damped.csv
  quiesce replay step.csv --column accel_m_s2 --unit m_s2
  quiesce record sim_hil/data/rigs/two_storeys.toml --out rig.mat

One row a control tick: t_s and accel_m_s2, with the noise and the resolution of the plant's
sensor. Of a scenario with a board one column a sensor, its name and unit: roof_accel_m_s2,
upper_stroke_mm; a sensor with a period keeps its value from one sample to the next.
"""

# What a column is in, by the unit of its sensor.
RECORDED_UNITS = {"um/s2": "m_s2", "um/s": "m_s", "nm": "mm", "mN": "N"}


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "record",
        description="Run a scenario and keep what its simulated sensors measured, as a recording\n"
        "for 'quiesce replay'.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scenario", metavar="SCENARIO", help="name or .toml file")
    parser.add_argument(
        "--law", default=laws.OPEN_LOOP, metavar="NAME",
        help=f"one of {', '.join(law.name for law in laws.LAWS if law.name != laws.CONSTANT_BEST)}"
        " (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="parameter, repeatable"
    )
    parser.add_argument(
        "--from-s", type=finite_number, default=0.0, metavar="T", help="(%(default)s)"
    )
    parser.add_argument("--to-s", type=finite_number, metavar="T", help="(the scenario's end)")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FILE",
        help="CSV, or what its suffix asks for: .mat (MATLAB), .uff (universal file 58)",
    )  # fmt: skip
    parser.set_defaults(run=run)


def count_m_s2(plant_file: Path) -> float:
    """Acceleration of one count of the plant's sensor."""
    sensor = scenarios.read_toml(plant_file)["sensor"]
    return sensor["full_scale_g"] * M_S2_PER_UNIT["g"] / 2 ** (sensor["bits"] - 1)


def held(counts: np.ndarray, is_due: np.ndarray) -> np.ndarray:
    """Of each tick the last count that was due."""
    return counts[np.maximum.accumulate(np.where(is_due, np.arange(len(counts)), 0))]


def measured(scenario: scenarios.Scenario, trace: Trace) -> dict[str, np.ndarray]:
    """What each sensor measured, by the name of its column."""
    if scenario.board is None:
        return {"accel_m_s2": trace["accel_counts"] * count_m_s2(scenario.plant_file)}
    ticks, rate_Hz = len(trace["t_s"]), round(1.0 / trace["t_s"][1])
    columns = {}
    for sensor in scenario.board.sensors:
        unit = RECORDED_UNITS[sensor.unit]
        counts = held(trace[f"{sensor.name}_counts"], sensor.is_due(ticks, rate_Hz))
        columns[f"{sensor.name}_{unit}"] = sensor.values(counts) / COLUMN_UNITS[sensor.unit][unit]
    return columns


def write(file: Path, time_s: np.ndarray, columns: dict[str, np.ndarray]) -> None:
    """As the suffix asks for; text without one that is known."""
    texts = {name: "{:.6f}".format for name in columns}
    write_columns(file, {"t_s": time_s, **columns}, {**texts, "t_s": time_text})


def run(args: argparse.Namespace) -> int:
    require_writer(args.out.suffix)
    bench = Bench()
    law, scenario = laws.find(args.law), scenarios.load(bench, args.scenario)
    if law.name == laws.CONSTANT_BEST:
        raise UsageError(f"--law {law.name}: that is a search over many runs; name another law")
    options = ["--scenario", str(scenario.file), "--law", law.bench_law]
    options += setting_options([*law.settings, *args.set])
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        trace_file = Path(folder) / "trace"
        bench.call("run", *options, "--trace", str(trace_file))
        trace = read_trace(trace_file)
    time_s, columns = trace["t_s"], measured(scenario, trace)
    end_s = np.inf if args.to_s is None else args.to_s
    chosen = (time_s >= args.from_s) & (time_s < end_s)
    if not chosen.any():
        raise UsageError(
            f"--from-s {args.from_s:g} --to-s {end_s:g}: no sample; the scenario spans "
            f"{time_s[0]:g} .. {time_s[-1]:g} s"
        )
    with output_files(args.out.parent) as staging:
        kept = {name: values[chosen] for name, values in columns.items()}
        write(staging / args.out.name, time_s[chosen], kept)
    print(f"{shown(args.out)}: {int(chosen.sum())} rows of {scenario.name}, law {law.name}")
    return 0
