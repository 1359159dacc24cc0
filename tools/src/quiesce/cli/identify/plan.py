"""`quiesce identify plan`: which tests to run for a damper, and the files to play."""

import argparse
import json
from pathlib import Path

import tomli_w

from quiesce.base.atomic import output_files
from quiesce.base.command import real_number
from quiesce.base.paths import shown
from quiesce.base.table import format_table
from quiesce.cli.file_format import add_format, require_format
from quiesce.cli.identify.help import fill
from quiesce.cli.terminal import show
from quiesce.damper import sines_and_chirps
from quiesce.damper.plain import plain
from quiesce.damper.plan import KINDS, Damper, Plan, Test, excitation, make_plan, needs
from quiesce.recording.write import write_columns

NAME = "plan"
HELP = "which tests to run for a damper"
# A damper of 2 kN and 50 mm weighs about 0.9 kg.
_MASS_kg_J = 0.9 / (2000.0 * 0.05)
# Of the excitations.
TEXTS = {"time_s": "{:.4f}".format, "disp_m": "{:.7f}".format, "current_A": "{:g}".format}
EPILOG = """Without --max-speed-m-s the largest speed is that of --rig-max-Hz at the usable
amplitude, at most 0.3 m/s. Amplitudes use 80 % of the stroke. --out writes plan.csv, plan.toml
and, for every test, a file to play (--format): time_s, disp_m (from mid-stroke), current_A. Record
the force beside it as force_N and give the files to quiesce identify; hold the random ones out.

examples:
  quiesce identify plan --stroke-mm 50 --max-force-N 2000 --max-current-A 2
  quiesce identify plan --stroke-mm 50 --max-force-N 2000 --max-current-A 2 --out build/plan
  quiesce identify plan --protocol sines-chirps --stroke-mm 12.5 --max-current-A 1.5 \\
      --rig-max-Hz 2.5 --max-force-N 2000
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    fill(parser, EPILOG)

    def needed(name: str, high: float, what: str, text: str, least: float = 1e-3) -> None:
        unit = name.rsplit("-", 1)[1]
        parser.add_argument(
            name, required=True, type=real_number(least, high, what), metavar=unit, help=text
        )

    needed("--stroke-mm", 1e4, "a length in mm", "stroke from end to end")
    needed("--max-force-N", 1e8, "a force in N", "largest force, at the largest current")
    needed("--max-current-A", 1e3, "a current in A", "largest coil current")
    parser.add_argument(
        "--max-speed-m-s", type=real_number(1e-5, 100.0, "a speed in m/s"), metavar="m/s",
        help="largest speed that the model is for",
    )  # fmt: skip
    parser.add_argument(
        "--rig-max-Hz", type=real_number(0.1, 1000.0, "a frequency in Hz"), metavar="Hz",
        default=10.0,
        help="fastest sine of the rig (%(default)g)",
    )  # fmt: skip
    parser.add_argument(
        "--mass-kg", type=real_number(1e-4, 1e5, "a mass in kg"), metavar="kg",
        help="mass of the damper, for its heating (guessed from force and stroke)",
    )  # fmt: skip
    parser.add_argument(
        "--protocol", choices=("full", "sines-chirps"), default="full",
        help="full: all that tells dampers apart; sines-chirps: the 24 sines and 4 chirps that the "
        "self-tuning fuzzy model was published with, up to the limits stated here (%(default)s)",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="write plan and excitations")
    add_format(parser, "the excitations")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    require_format(args)
    damper = damper_of(args)
    plan = make_plan(damper) if args.protocol == "full" else sines_and_chirps.make_plan(damper)
    if args.out:
        write_plan(args.out, plan, args.format)
    show(json.dumps(numbers_of(plan, args.format), indent=1) if args.json else text_of(plan))
    if args.out and not args.json:
        print(f"\nwritten: {shown(args.out)}/plan.csv, plan.toml and {len(plan.tests)} excitations")
    return 0


def damper_of(args: argparse.Namespace) -> Damper:
    stroke_m = 1e-3 * args.stroke_mm
    mass_kg = args.mass_kg or max(0.02, _MASS_kg_J * args.max_force_N * stroke_m)
    damper = Damper(
        stroke_m, args.max_force_N, args.max_current_A, 1.0, args.rig_max_Hz, mass_kg
    )  # fmt: skip
    reach_m_s = 6.2832 * damper.rig_max_Hz * damper.amplitude_m
    speed_m_s = args.max_speed_m_s or min(0.3, reach_m_s)
    return Damper(
        stroke_m, args.max_force_N, args.max_current_A, speed_m_s, args.rig_max_Hz, mass_kg
    )  # fmt: skip


def command_text(test: Test) -> str:
    return "switched" if test.current_A is None else f"{test.current_A:g}"


def groups(plan: Plan) -> list[list[Test]]:
    """Tests that differ in the current only."""
    found: dict[tuple, list[Test]] = {}
    for test in plan.tests:
        key = (test.kind, test.amplitude_m, test.freq_Hz)
        found.setdefault(key, []).append(test)
    return list(found.values())


def duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"


def text_of(plan: Plan) -> str:
    head = ["test", "mm||.3g", "Hz||.3g", "m/s||.3g", "A", "files", "in all", "up to K||.1f"]
    rows = [
        [
            tests[0].kind.replace("_", " "),
            1e3 * tests[0].amplitude_m, tests[0].freq_Hz or None, tests[0].speed_m_s,
            ", ".join(dict.fromkeys(map(command_text, tests))), len(tests),
            duration(sum(test.duration_s for test in tests)),
            max(test.heating_K for test in tests),
        ]
        for tests in groups(plan)
    ]  # fmt: skip
    kinds = [kind for kind in KINDS if any(test.kind == kind for test in plan.tests)]
    return "\n".join(
        [
            format_table(head, rows, left=(0, 4)),
            "",
            f"{len(plan.tests)} tests, {duration(plan.recording_s)} of recording, "
            f"{duration(plan.total_s)} with pauses to cool (a damper of about "
            f"{plan.damper.mass_kg:.2g} kg)",
            "",
            "What each tells:",
            *(f"- {kind.replace('_', ' ')}: {KINDS[kind]}" for kind in kinds),
            "",
            "Needed:",
            *(f"- {line}" for line in needs(plan)),
            "",
            "Warnings:",
            *(f"- {line}" for line in plan.warnings),
        ]
    )


def numbers_of(plan: Plan, ending: str) -> dict:
    return plain(
        {
            "damper": vars(plan.damper),
            "rate_Hz": plan.rate_Hz,
            "recording_s": plan.recording_s,
            "total_s": plan.total_s,
            "needs": needs(plan),
            "warnings": plan.warnings,
            "tests": [
                {**vars(test), "file": file_name(plan, test, ending), "tells": KINDS[test.kind]}
                for test in plan.tests
            ],
        }
    )


def file_name(plan: Plan, test: Test, ending: str) -> str:
    """In the order in which to run them."""
    return f"{plan.tests.index(test) + 1:02d}_{test.name}.{ending}"


def table_text(plan: Plan, ending: str) -> str:
    head = "file,kind,amplitude_mm,freq_Hz,speed_m_s,current_A,duration_s,pause_s,heating_K"
    lines = [head]
    for test in plan.tests:
        numbers = (1e3 * test.amplitude_m, test.freq_Hz, test.speed_m_s)
        times = (test.duration_s, test.pause_s, test.heating_K)
        cells = [
            file_name(plan, test, ending), test.kind, *(f"{value:.6g}" for value in numbers),
            command_text(test), *(f"{value:.4g}" for value in times),
        ]  # fmt: skip
        lines.append(",".join(cells))
    return "\n".join([*lines, ""])


def write_excitation(file: Path, plan: Plan, test: Test) -> None:
    found = excitation(plan, test)
    columns = {"time_s": found.time_s, "disp_m": found.disp_m, "current_A": found.current_A}
    write_columns(file, columns, TEXTS)


def write_plan(folder: Path, plan: Plan, ending: str) -> None:
    numbers = numbers_of(plan, ending)
    for test in numbers["tests"]:
        if test["current_A"] is None:
            test["current_A"] = "switched"
    with output_files(folder) as staging:
        (staging / "plan.csv").write_text(table_text(plan, ending), encoding="utf-8")
        (staging / "plan.toml").write_text(tomli_w.dumps(numbers), encoding="utf-8")
        for test in plan.tests:
            write_excitation(staging / file_name(plan, test, ending), plan, test)
