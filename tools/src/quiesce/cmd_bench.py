"""`quiesce bench NAME`: measured figures beside their goals. One module a bench."""

import argparse
import json
from pathlib import Path

from quiesce import bench_can, bench_control, bench_fuzzy, bench_identify, bench_signal, bench_sweep
from quiesce.atomic import output_files
from quiesce.paths import build_folder, shown

# Each has NAME, HELP, DESCRIPTION, add_options(parser) and measure(args, folder) -> Report, which
# writes its plots into the folder. UsageError for bad input, before anything is measured.
BENCHES = (bench_signal, bench_fuzzy, bench_control, bench_sweep, bench_identify, bench_can)

EXIT_CODES = """--json prints one object {"bench", "figures", "context"}; a figure has name, value,
unit, goal, better (lower or higher) and ok. The output folder receives it as NAME.json, too.
Exit codes with --check: 1 a figure misses its goal, 3 a goal could not be judged because its data
or tool is absent.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "bench",
        help="measured figures beside their goals",
        description="Measure, and compare with the goals.",
    )
    names = parser.add_subparsers(metavar="NAME", required=True)
    for bench in BENCHES:
        one = names.add_parser(
            bench.NAME,
            help=bench.HELP,
            description=bench.DESCRIPTION,
            epilog=EXIT_CODES,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        one.add_argument("--json", action="store_true", help="print one JSON object")
        one.add_argument("--check", action="store_true", help="fail where a goal is missed")
        one.add_argument("--quick", action="store_true", help="fewer trials, the same figures")
        one.add_argument(
            "--out", type=Path, metavar="DIR", help=f"folder to write to (build/bench/{bench.NAME})"
        )
        bench.add_options(one)
        one.set_defaults(run=run, bench=bench)


def run(args: argparse.Namespace) -> int:
    out = args.out or build_folder() / "bench" / args.bench.NAME
    with output_files(out) as staging:
        report = args.bench.measure(args, staging)
        text = json.dumps(report.json_object(), indent=1)
        (staging / f"{args.bench.NAME}.json").write_text(text + "\n", encoding="utf-8")
        written = sorted(file.name for file in staging.iterdir())
    if args.json:
        print(text)
    else:
        print(report.text())
        print(f"\nwritten    {', '.join(shown(out / name) for name in written)}")
    return report.exit_code(args.check)
