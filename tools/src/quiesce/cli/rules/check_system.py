"""`quiesce rules check` of a file that is no plain rule base: a system of any kind."""

import argparse
import json
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any

from quiesce.base.errors import EXIT_FAILED
from quiesce.rules.analysis.findings import ERROR
from quiesce.rules.analysis.systems.analyse import Analysis, analyse_system
from quiesce.rules.analysis.systems.sample import place_text
from quiesce.rules.engine.precise import Precise
from quiesce.rules.proof.system_walk import SystemOutputWalk, SystemWalk, walk_system
from quiesce.rules.system.compile import CompiledSystem
from quiesce.rules.system.model import System
from quiesce.table.words import WORD_BYTES

MANY = 10**15


def check_system(
    args: argparse.Namespace, precise: Precise, why: str, progress: Callable[[int, int], None]
) -> int:
    """why: it is no plain rule base. Prints; returns the exit code."""
    compiled = precise.compiled
    found = analyse_system(compiled.system)
    walked = walk_system(compiled, args.quick, progress)
    problems = failures(found, walked, args.max_error)
    if args.json:
        print(json.dumps(report(compiled, why, found, walked, problems), indent=2))
    else:
        print("\n".join(text(compiled, why, found, walked)))
        print("result     " + ("; ".join(problems) if problems else "ok"))
    return EXIT_FAILED if problems else 0


def failures(found: Analysis, walked: SystemWalk, max_error: float | None) -> list[str]:
    problems = []
    errors = sum(finding.severity == ERROR for finding in found.findings)
    if errors:
        problems.append(f"{errors} finding{'s are errors' if errors > 1 else ' is an error'}")
    for output in walked.outputs:
        if output.default_differs:
            problems.append(f"{output.name} has its default at points where rules fire")
        if max_error is not None and output.unit_error > max_error:
            problems.append(f"{output.name} is off by {output.unit_error:.3g}, above {max_error:g}")
    return problems


def text(compiled: CompiledSystem, why: str, found: Analysis, walked: SystemWalk) -> list[str]:
    lines = [f"kind       a system, no plain rule base: {why}"]
    lines += [f"{one.severity:<10} {one.text} [{one.basis}]" for one in found.findings] or [
        "findings   none"
    ]
    lines += [f"note       {note}" for note in compiled.notes]
    lines += [f"{one.what:<10} {one.output}: {one.text} [{one.basis}]" for one in found.facts]
    lines += [
        f"points     {walked.points:,}: {points_text(walked)}",
        f"engine     fuzzy_system.c, {WORD_BYTES * len(compiled.words)} bytes; curves within "
        f"{compiled.curve_error:.2g}",
    ]
    for index, output in enumerate(walked.outputs):
        lines += output_text(compiled, walked, output, index)
    lines.append("arithmetic no overflow, no division by zero: the sanitizer saw none")
    return lines


def points_text(walked: SystemWalk) -> str:
    if walked.is_complete:
        return "every integer inside the universes, and int32's ends"
    inside = f"{walked.inside:,}" if walked.inside < MANY else f"{walked.inside:.2g}"
    return (
        "random ones, corners of the sets, around the worst, int32's ends "
        f"({inside} integers inside)"
    )


def basis(walked: SystemWalk) -> str:
    return "every integer" if walked.is_complete else "sampled"


def output_text(
    compiled: CompiledSystem, walked: SystemWalk, output: SystemOutputWalk, index: int
) -> list[str]:
    told = f"[{basis(walked)}]"
    if output.unit_error < 0:
        return [f"output     {output.name}: at no point does a rule fire by a thousandth {told}"]
    system = compiled.system
    one = system.outputs[index]
    share = 100 / (one.maximum - one.minimum)
    lines = [
        f"output     {output.name}: {output.least:.6g} .. {output.most:.6g}, one count is "
        f"{float(compiled.output_axes[index].lsb):.3g} {told}",
        f"error      {output.unit_error:.3g} at most ({share * output.unit_error:.2g} % of the "
        f"range), at {place_text(system, output.at)}: {output.value:.8g} for "
        f"{output.reference:.8g}; at 99 % of the points {output.most_error:.3g} {told}",
    ]
    if output.defaults:
        pct = 100 * output.defaults / walked.points
        lines.append(
            f"default    {output.name}: at {output.defaults:,} points ({pct:.3g} %) {told}"
        )
    if output.default_differs:
        lines.append(
            f"default    {output.name}: at {output.default_differs:,} points only one of integers "
            f"and float64 has it (first at {place_text(system, output.differs_at)}) {told}"
        )
    if output.weak:
        lines.append(
            f"weak       {output.name}: at {output.weak:,} points its rules fire, but none by a "
            f"thousandth: not judged; the integers there are {output.weak_least:.6g} .. "
            f"{output.weak_most:.6g}, or the default {told}"
        )
    return lines


def finite(entry: dict[str, Any]) -> dict[str, Any]:
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in entry.items()
    }


def facts_of(found: Analysis, name: str) -> list[dict[str, Any]]:
    return [
        {"what": one.what, "text": one.text, "basis": one.basis}
        for one in found.facts
        if one.output == name
    ]


def report(
    compiled: CompiledSystem,
    why: str,
    found: Analysis,
    walked: SystemWalk,
    problems: Sequence[str],
) -> dict[str, Any]:
    """The keys of a plain rule base's report where both have them."""
    system: System = compiled.system
    return {
        "name": system.name,
        "not_plain": why,
        "findings": [asdict(finding) for finding in found.findings],
        "notes": list(compiled.notes),
        "points": walked.points,
        "is_complete": walked.is_complete,
        "table_bytes": WORD_BYTES * len(compiled.words),
        "outputs": [
            {**finite(asdict(output)), "facts": facts_of(found, output.name)}
            for output in walked.outputs
        ],
        "problems": list(problems),
    }
