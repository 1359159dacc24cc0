"""`./tools/benchmark controller`: one controller for any rig, what it costs and what it takes."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.engine.bench import Bench

from quiesce_benchmarks.controller import added_law, boards, instructions, same_words, sizes
from quiesce_benchmarks.house import structure
from quiesce_benchmarks.report import Figure, Report

NAME = "controller"
HELP = "boards, laws and sensors: instructions, state, same words on host and image"
DESCRIPTION = """Instructions of the control tick by law (worst over all scenarios that ship, the
emulated board's image of one sensor and one damper), what one more sensor and damper cost, bytes
of state, words that differ between host and image on random boards, what it takes to add a law
(the example, built in a clone), malformed boards that are refused in one line, and the golden
traces."""

# Name, unit, goal, better.
FIGURES = (
    ("golden_words_differing", "words", 0, "lower"),
    ("fuzzy_median_instr", "instructions", 2400, "lower"),
    ("fuzzy_worst_instr", "instructions", 3300, "lower"),
    ("selftune_worst_instr", "instructions", 3400, "lower"),
    ("phase_worst_instr", "instructions", 3800, "lower"),
    ("sensor_extra_instr", "instructions", 250, "lower"),
    ("damper_extra_instr", "instructions", 150, "lower"),
    ("state_bytes_1x1", "bytes", 12288, "lower"),
    ("state_bytes_8x4", "bytes", 24576, "lower"),
    ("mismatched_words", "words", 0, "lower"),
    ("law_added_lines", "lines", 1, "lower"),
    ("law_added_files", "files", 1, "lower"),
    ("boards_refused", "files", 100, "higher"),
    ("boards_not_refused", "files", 0, "lower"),
)
BOARDS = 40
QUICK_BOARDS = 10


def add_options(parser: argparse.ArgumentParser) -> None:
    """None of its own."""


def measure(args: argparse.Namespace, folder: Path) -> Report:
    bench = Bench()
    values: dict[str, float] = {}
    absent: list[str] = []

    def take(what: str, work: Callable[[], dict[str, float]]) -> None:
        print(f"controller: {what}", file=sys.stderr, flush=True)
        try:
            values.update(work())
        except (BenchFailure, UsageError) as error:
            absent.append(f"{what}: {error}")

    take("golden traces", golden)
    take("instructions by law", lambda: laws(bench, args.quick))
    take("one more sensor, one more damper", lambda: extra(bench))
    take("state", state)
    take("random boards on host and image", lambda: same(bench, args.quick))
    take("malformed boards", lambda: malformed(bench))
    take("a law that is added", added_law.added)
    figures = [Figure(name, values.get(name), *rest) for name, *rest in FIGURES]
    context = {key: value for key, value in values.items() if key not in {f.name for f in figures}}
    return Report(NAME, figures, context, (), absent)


def golden() -> dict[str, float]:
    differing, words = structure.golden_words_differing()
    return {"golden_words_differing": differing, "golden_words": words}


def laws(bench: Bench, quick: bool) -> dict[str, float]:
    found = instructions.of_laws(bench, quick)
    return {
        "off_median_instr": found["off"][0],
        "off_worst_instr": found["off"][1],
        "fuzzy_median_instr": found["fuzzy"][0],
        "fuzzy_worst_instr": found["fuzzy"][1],
        "selftune_worst_instr": found["fuzzy_selftune"][1],
        "phase_median_instr": found["phase"][0],
        "phase_worst_instr": found["phase"][1],
    }


def extra(bench: Bench) -> dict[str, float]:
    found = instructions.extra(bench)
    return {"sensor_extra_instr": found["sensor"], "damper_extra_instr": found["damper"]}


def state() -> dict[str, float]:
    return {
        "state_bytes_1x1": sizes.state_bytes(1, 1, 1),
        "state_bytes_8x4": sizes.state_bytes(8, 4, 4),
    }


def same(bench: Bench, quick: bool) -> dict[str, float]:
    differing, compared = same_words.mismatched_words(bench, QUICK_BOARDS if quick else BOARDS)
    return {"mismatched_words": differing, "compared_words": compared}


def malformed(bench: Bench) -> dict[str, float]:
    tried, refused = boards.refused(bench)
    return {"boards_refused": refused, "boards_not_refused": tried - refused}
