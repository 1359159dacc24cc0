"""`quiesce rules check FILE`: what is wrong with a rule base, and how exact its integers are."""

import argparse
import json
import math
import sys
import time
from dataclasses import asdict
from typing import Any

from quiesce.base.command import finite_number
from quiesce.base.errors import EXIT_FAILED, UsageError
from quiesce.cli.rules.check_system import check_system
from quiesce.cli.rules.formats import FORMATS_HELP, add_file_options, plain_or_table_from
from quiesce.rules.analysis.analyse import analyse
from quiesce.rules.analysis.findings import ERROR, Finding
from quiesce.rules.engine.precise import Precise
from quiesce.rules.integers.bound import error_bounds
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.integers.emit import why_not_straight
from quiesce.rules.integers.table import table_words
from quiesce.rules.proof.walk import MAX_WALKED_POINTS, OutputWalk, Walk, walk
from quiesce.rules.proof.walk_model import grid_points

EPILOG = f"""{FORMATS_HELP}
what is done:
  - the rule base is read for gaps, contradictions, rules that never fire, sets that nothing uses,
    and cells where the output turns around;
  - the firmware's own C (the table engine, and straight-line C where the base has it) is built
    with the undefined-behaviour sanitizer and evaluated at every input integer, if they are at most
    2^32, and in every cell of the piecewise linear form in any case, beside an exact reference in
    double precision: worst error and where, range of the output, agreement of the engines;
  - for a weighted average the error is also bounded from the integers' rounding alone.

of a file that is no plain rule base (other norms, smooth sets, hedges, values that depend on
inputs; the first line says why):
  - the same findings; where no rule fires, and which never do, is proved from corners and knots of
    the sets, whatever the norms, and sampled where that does not tell; jumps are looked for; each
    line ends in [proved] or [sampled];
  - the engine for any system (fuzzy_system.c), built with the sanitizer, is evaluated at every
    input integer where they are few, else at random ones, at corners and around the worst found.
    Points where no rule fires by a thousandth are counted, not judged.

exit codes: 0 fine; 1 a finding is an error, an engine overflows or both differ, or the worst error
is above --max-error; 2 bad input

examples:
  quiesce rules check tools/benchmarks/rules/reference_singleton.fcl
  quiesce rules check firmware/plants/squeeze_2012/rules.fcl --controller
  quiesce rules check fan.fis --lsb temperature=0.01 --max-error 0.5 --json
  quiesce rules check gaussians.fll
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "check",
        help="findings, and the integers' error at every input",
        description="Find what is wrong with a rule base, and prove how exact its integers are.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_file_options(parser)
    parser.add_argument(
        "--max-error",
        type=finite_number,
        metavar="X",
        help="fail above this error, in the output's unit",
    )
    parser.add_argument(
        "--jobs", type=int, default=0, metavar="N",
        help="at once, of a plain rule base (all processors)",
    )  # fmt: skip
    parser.add_argument(
        "--quick", action="store_true", help="sampled instead of every integer; fewer of a system"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    if args.jobs < 0:
        raise UsageError(f"--jobs {args.jobs}: 0 or more, please")
    if args.max_error is not None and not args.max_error >= 0:
        raise UsageError(f"--max-error {args.max_error}: 0 or more, please")
    compiled, why = plain_or_table_from(args)
    progress = WalkProgress()
    if isinstance(compiled, Precise):
        return check_system(args, compiled, why, progress.report)
    findings = analyse(compiled.base)
    walked = walk(compiled, args.jobs, 0 if args.quick else MAX_WALKED_POINTS, progress.report)
    bounds = error_bounds(compiled)
    problems = failures(findings, walked, bounds, args.max_error)
    if args.json:
        print(json.dumps(report(compiled, findings, walked, bounds, problems), indent=2))
    else:
        print("\n".join(text(compiled, findings, walked, bounds)))
        print("result     " + ("; ".join(problems) if problems else "ok"))
    return EXIT_FAILED if problems else 0


class WalkProgress:
    """A line every few seconds, with the time to go."""

    INTERVAL_S = 5.0

    def __init__(self) -> None:
        self._start_s = self._last_s = time.monotonic()

    def report(self, done: int, total: int) -> None:
        now_s = time.monotonic()
        if now_s - self._last_s < self.INTERVAL_S or done == 0:
            return
        self._last_s = now_s
        left_s = (now_s - self._start_s) * (total - done) / done
        share = 100 * done / total
        print(
            f"walked {share:.0f} % of {total:,} points  (about {left_s:.0f} s to go)",
            file=sys.stderr,
        )


def failures(
    findings: list[Finding],
    walked: Walk,
    bounds: list[float | None],
    max_error: float | None,
) -> list[str]:
    problems = []
    errors = sum(finding.severity == ERROR for finding in findings)
    if errors:
        problems.append(f"{errors} finding{'s are errors' if errors > 1 else ' is an error'}")
    if walked.engines_differ > 0:
        problems.append(f"the engines differ at {walked.engines_differ:,} points")
    for output, bound in zip(walked.outputs, bounds, strict=True):
        if bound is not None and output.unit_error > bound:
            problems.append(f"{output.name} is off by more than its proved bound")
        if bound is not None and output.default_differs:
            problems.append(f"{output.name} has its default at points where rules fire")
        if max_error is not None and output.unit_error > max_error:
            problems.append(f"{output.name} is off by {output.unit_error:.3g}, above {max_error:g}")
    return problems


def text(
    compiled: CompiledBase, findings: list[Finding], walked: Walk, bounds: list[float | None]
) -> list[str]:
    lines = [f"{finding.severity:<10} {finding.text}" for finding in findings] or [
        "findings   none"
    ]
    lines += [f"note       {note}" for note in compiled.notes]
    every = "every integer inside the universes and " if walked.is_complete else ""
    lines.append(
        f"points     {walked.points:,}: {every}every cell, sampled, beyond the universes too "
        f"({grid_points(compiled):,} integers inside)"
    )
    reason = why_not_straight(compiled)
    lines.append(
        f"engines    table, {4 * len(table_words(compiled))} bytes; straight-line C "
        + (f"has no form: {reason}" if reason else agreement(walked))
    )
    for index, output in enumerate(walked.outputs):
        lines += output_text(compiled, walked.points, output, bounds[index], index)
    lines.append("arithmetic no overflow, no division by zero: the sanitizer saw none")
    return lines


def agreement(walked: Walk) -> str:
    return "gives the same bits" if walked.engines_differ == 0 else "DIFFERS"


def output_text(
    compiled: CompiledBase, points: int, output: OutputWalk, bound: float | None, index: int
) -> list[str]:
    names = [variable.name for variable in compiled.base.inputs]
    if output.unit_error < 0:
        return [f"output     {output.name}: no rule fires anywhere"]
    where = ", ".join(f"{name} = {x:.6g}" for name, x in zip(names, output.at, strict=True))
    proved = "no bound from the rounding alone" if bound is None else f"proved below {bound:.3g}"
    lines = [
        f"output     {output.name}: {output.least:.6g} .. {output.most:.6g}, one count is "
        f"{compiled.output_lsb(index):.3g}",
        f"error      {output.unit_error:.3g} at most, at {where}: {output.value:.8g} for "
        f"{output.reference:.8g}; {proved}",
    ]
    if output.defaults:
        share = 100 * output.defaults / points
        lines.append(f"default    {output.name}: at {output.defaults:,} points ({share:.3g} %)")
    if output.default_differs:
        at = ", ".join(f"{n} = {x:.6g}" for n, x in zip(names, output.differs_at, strict=True))
        lines.append(
            f"default    {output.name}: at {output.default_differs:,} points a rule fires too "
            f"weakly for the integers, or fires by rounding (first at {at})"
        )
    return lines


def report(
    compiled: CompiledBase,
    findings: list[Finding],
    walked: Walk,
    bounds: list[float | None],
    problems: list[str],
) -> dict[str, Any]:
    outputs = []
    for output, bound in zip(walked.outputs, bounds, strict=True):
        entry = {
            key: None if isinstance(value, float) and not math.isfinite(value) else value
            for key, value in asdict(output).items()
        }
        outputs.append({**entry, "proved_bound": bound})
    return {
        "name": compiled.base.name,
        "findings": [asdict(finding) for finding in findings],
        "notes": list(compiled.notes),
        "points": walked.points,
        "is_complete": walked.is_complete,
        "engines_differ": walked.engines_differ,
        "table_bytes": 4 * len(table_words(compiled)),
        "membership_bits": compiled.bits,
        "not_straight": why_not_straight(compiled),
        "outputs": outputs,
        "problems": problems,
    }
