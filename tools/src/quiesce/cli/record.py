"""`quiesce record SCENARIO`: what the simulated accelerometer measured, as a recording."""

import argparse
import tempfile
from pathlib import Path

import numpy as np

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.engine import laws, scenarios
from quiesce.engine.bench import Bench, setting_options
from quiesce.engine.trace import read_trace
from quiesce.signal.recording import M_S2_PER_UNIT

EPILOG = """examples:
  quiesce record step_10_20Hz --from-s 2 --to-s 8 --out step.csv
  quiesce record sine_5Hz --law fuzzy --out damped.csv
  quiesce replay step.csv --column accel_m_s2 --unit m_s2

One row a control tick: t_s and accel_m_s2, with the noise and the resolution of the plant's
sensor.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "record",
        description="Run a scenario and keep what its simulated accelerometer measured, as a\n"
        "recording for 'quiesce replay'.",
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
    parser.add_argument("--from-s", type=float, default=0.0, metavar="T", help="(%(default)s)")
    parser.add_argument("--to-s", type=float, metavar="T", help="(the scenario's end)")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.csv")
    parser.set_defaults(run=run)


def count_m_s2(plant_file: Path) -> float:
    """Acceleration of one count of the plant's sensor."""
    sensor = scenarios.read_toml(plant_file)["sensor"]
    return sensor["full_scale_g"] * M_S2_PER_UNIT["g"] / 2 ** (sensor["bits"] - 1)


def run(args: argparse.Namespace) -> int:
    bench = Bench()
    law, scenario = laws.find(args.law), scenarios.load(bench, args.scenario)
    if law.name == laws.CONSTANT_BEST:
        raise UsageError(f"--law {law.name}: that is a search over many runs; name another law")
    options = ["--scenario", str(scenario.file), "--law", law.bench_law]
    options += setting_options([*law.settings, *args.set])
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        trace_file = Path(folder) / "trace"
        bench.call("run", *options, "--trace", str(trace_file))
        trace = read_trace(trace_file, ["t_s", "accel_counts"])
    time_s, accel_m_s2 = trace["t_s"], trace["accel_counts"] * count_m_s2(scenario.plant_file)
    end_s = np.inf if args.to_s is None else args.to_s
    chosen = (time_s >= args.from_s) & (time_s < end_s)
    if not chosen.any():
        raise UsageError(
            f"--from-s {args.from_s:g} --to-s {end_s:g}: no sample; the scenario spans "
            f"{time_s[0]:g} .. {time_s[-1]:g} s"
        )
    with output_files(args.out.parent) as staging, (staging / args.out.name).open("w") as file:
        file.write("t_s,accel_m_s2\n")
        for t_s, value in zip(time_s[chosen], accel_m_s2[chosen], strict=True):
            file.write(f"{t_s:.6f}".rstrip("0").rstrip(".") + f",{value:.6f}\n")
    print(f"{shown(args.out)}: {int(chosen.sum())} rows of {scenario.name}, law {law.name}")
    return 0
