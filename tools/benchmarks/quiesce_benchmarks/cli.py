"""`./tools/benchmark NAME`: measured figures beside their goals. One module a benchmark."""

import argparse
import json
import sys
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.command import Parser, exit_code_of
from quiesce.base.paths import build_folder, shown

from quiesce_benchmarks.board import benchmark as board_benchmark
from quiesce_benchmarks.campaign import benchmark as campaign_benchmark
from quiesce_benchmarks.can import benchmark as can_benchmark
from quiesce_benchmarks.control import benchmark as control_benchmark
from quiesce_benchmarks.controller import benchmark as controller_benchmark
from quiesce_benchmarks.damper import benchmark as damper_benchmark
from quiesce_benchmarks.fuzzy import benchmark as fuzzy_benchmark
from quiesce_benchmarks.house import benchmark as house_benchmark
from quiesce_benchmarks.install import benchmark as install_benchmark
from quiesce_benchmarks.laws import benchmark as laws_benchmark
from quiesce_benchmarks.live import benchmark as live_benchmark
from quiesce_benchmarks.lock import benchmark as lock_benchmark
from quiesce_benchmarks.papers import benchmark as papers_benchmark
from quiesce_benchmarks.signal import benchmark as signal_benchmark
from quiesce_benchmarks.sweep import benchmark as sweep_benchmark
from quiesce_benchmarks.tables import benchmark as tables_benchmark
from quiesce_benchmarks.trust import benchmark as trust_benchmark
from quiesce_benchmarks.unseen import benchmark as unseen_benchmark

# Each has NAME, HELP, DESCRIPTION, add_options(parser) and measure(args, folder) -> Report, which
# writes its plots into the folder. UsageError for bad input, before anything is measured.
BENCHMARKS = (
    signal_benchmark,
    fuzzy_benchmark,
    control_benchmark,
    sweep_benchmark,
    damper_benchmark,
    can_benchmark,
    controller_benchmark,
    house_benchmark,
    trust_benchmark,
    papers_benchmark,
    laws_benchmark,
    tables_benchmark,
    install_benchmark,
    lock_benchmark,
    live_benchmark,
    board_benchmark,
    unseen_benchmark,
    campaign_benchmark,
)

EXIT_CODES = """--json prints one object {"bench", "figures", "context"}; a figure has name, value,
unit, goal, better (lower or higher) and ok. The output folder receives it as NAME.json, too.
Exit codes with --check: 1 a figure misses its goal, 3 a goal could not be judged because its data
or tool is absent.
"""


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="benchmark",
        description="Measure, and compare with the goals. Progress and errors go to stderr.",
        allow_abbrev=False,
    )
    names = parser.add_subparsers(metavar="NAME", required=True)
    for benchmark in BENCHMARKS:
        one = names.add_parser(
            benchmark.NAME,
            help=benchmark.HELP,
            description=benchmark.DESCRIPTION,
            epilog=EXIT_CODES,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        one.add_argument("--json", action="store_true", help="print one JSON object")
        one.add_argument("--check", action="store_true", help="fail where a goal is missed")
        one.add_argument("--quick", action="store_true", help="fewer trials, the same figures")
        one.add_argument(
            "--out", type=Path, metavar="DIR", help=f"(build/benchmark/{benchmark.NAME})"
        )
        benchmark.add_options(one)
        one.set_defaults(benchmark=benchmark)
    return parser


def run(args: argparse.Namespace) -> int:
    out = args.out or build_folder() / "benchmark" / args.benchmark.NAME
    with output_files(out) as staging:
        report = args.benchmark.measure(args, staging)
        text = json.dumps(report.json_object(), indent=1)
        (staging / f"{args.benchmark.NAME}.json").write_text(text + "\n", encoding="utf-8")
        written = sorted(file.name for file in staging.iterdir())
    if args.json:
        print(text)
    else:
        print(report.text())
        print(f"\nwritten    {', '.join(shown(out / name) for name in written)}")
    return report.exit_code(args.check)


def main(arguments: list[str] | None = None) -> int:
    """Runs one benchmark and returns its exit code; every failure is one line on stderr."""
    words = sys.argv[1:] if arguments is None else arguments
    return exit_code_of("benchmark", lambda: run(make_parser().parse_args(words)))
