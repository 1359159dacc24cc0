"""`./tools/benchmark house`: what the project costs its next reader and its next builder."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.paths import root

from quiesce_benchmarks.house import emergency, fresh, pages, readme, structure
from quiesce_benchmarks.house.timed import run_timed
from quiesce_benchmarks.report import Figure, Report

NAME = "house"
HELP = "the project itself: waiting times, circles of imports, README, golden traces"
DESCRIPTION = """Counts what sources and pages are (golden traces that differ, circles of imports,
names of rigs in the firmware, words of the README, figures that contradict each other), and times
what a person waits for. --full adds what needs fresh clones and the virtual machine: hours."""

# Name, unit, goal. Times are judged and never fail --check: machines differ.
TIMES = (
    ("hil_fresh_cpu_s", 240.0),
    ("test_fresh_s", 900.0),
    ("test_warm_s", 300.0),
    ("edit_s", 20.0),
    ("help_cpu_s", 0.3),
    ("version_cpu_s", 0.3),
    ("stop_s", 1.0),
)
COUNTS = (
    ("golden_words_differing", "words", 0.0, "lower"),
    ("vm_slow_ok", "of 10 runs", 10.0, "higher"),
    ("flat_modules", "files", 3.0, "lower"),
    ("import_circles", "1", 0.0, "lower"),
    ("readme_words", "words", 900.0, "lower"),
    ("readme_numbers", "1", 25.0, "lower"),
    ("figures_inconsistent", "1", 0.0, "lower"),
    ("firmware_rig_names", "1", 0.0, "lower"),
)


STARTS = ("help", "version")


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--full", action="store_true", help="also what needs fresh clones: hours")


def measure(args: argparse.Namespace, folder: Path) -> Report:
    values: dict[str, float] = {}
    absent: list[str] = []
    context = {"times_of": 1, "full": args.full}

    def take(what: str, work: Callable[[], dict[str, float]]) -> None:
        print(f"house: {what}", file=sys.stderr, flush=True)
        try:
            values.update(work())
        except (BenchFailure, UsageError) as error:
            absent.append(f"{what}: {error}")

    take("files and pages", files_and_pages)
    take("golden traces", golden)
    take("--help and --version", lambda: {f"{n}_cpu_s": cpu_s(f"--{n}") for n in STARTS})
    take("emergency stop", lambda: {"stop_s": emergency.stop_s(root())})
    if args.full:
        take("fresh clones", fresh.fresh_figures)
        take("a slow virtual machine", slow_machine)
    else:
        absent.append("fresh clones and the slow virtual machine: only with --full")
    return Report(NAME, figures_of(values), context, (), absent)


def figures_of(values: dict[str, float]) -> list[Figure]:
    counts = [Figure(name, values.get(name), *rest) for name, *rest in COUNTS]
    times = [Figure(n, values.get(n), "s", goal, "lower", is_gated=False) for n, goal in TIMES]
    return [*counts, *times]


def files_and_pages() -> dict[str, float]:
    text = (root() / "README.md").read_text(encoding="utf-8")
    inconsistent = pages.figures_inconsistent(root())
    circles = structure.import_circles()
    for line in [*inconsistent, *(" -> ".join(circle) for circle in circles)]:
        print(f"      {line}", file=sys.stderr)
    return {
        "flat_modules": structure.flat_modules(root()),
        "import_circles": len(circles),
        "readme_words": readme.readme_words(text),
        "readme_numbers": readme.readme_numbers(text),
        "figures_inconsistent": len(inconsistent),
        "firmware_rig_names": structure.firmware_rig_names(root()),
    }


def golden() -> dict[str, float]:
    differing, _ = structure.golden_words_differing()
    return {"golden_words_differing": differing}


def cpu_s(option: str) -> float:
    """Of ./tools/quiesce with that option, the least of three."""
    runs = [run_timed([root() / "tools/quiesce", option], root()) for _ in range(3)]
    for one in runs:
        if one.code != 0:
            raise BenchFailure(f"tools/quiesce {option} ended with {one.code}: {one.last_line}")
    return min(one.cpu_s for one in runs)


def slow_machine() -> dict[str, float]:
    """Runs of the virtual machine's tests that pass with the emulator held to its share."""
    from quiesce_vm.slow import RUNS, SHARE, run_once

    return {"vm_slow_ok": sum(run_once(SHARE).is_passed for _ in range(RUNS))}
