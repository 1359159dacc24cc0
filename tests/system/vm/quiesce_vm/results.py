"""What the guest prints for others: one JSON object a line, and at the end how its script ended.

    RESULT {"name": "sigterm", ...}
    TEST-RC 0

Everything else on the console is for a human who looks for a cause.
"""

import json
from typing import Any

from quiesce.base.errors import BenchFailure

RESULT = "RESULT "
ENDING = "TEST-RC "


def result_of(line: str) -> dict[str, Any] | None:
    """The line's result; None where it is none. BenchFailure where it is a broken one."""
    if not line.startswith(RESULT):
        return None
    try:
        result = json.loads(line[len(RESULT) :])
    except ValueError:
        result = None
    if not isinstance(result, dict) or not isinstance(result.get("name"), str):
        raise BenchFailure(f"the guest printed a result that is none: {line[:200]!r}")
    return result


def results_of(lines: list[str]) -> dict[str, dict[str, Any]]:
    """All results by name. BenchFailure where one is broken or comes twice, or where the script did
    not end by itself with 0."""
    results: dict[str, dict[str, Any]] = {}
    for line in lines:
        result = result_of(line)
        if result is None:
            continue
        if result["name"] in results:
            raise BenchFailure(f"the guest printed the result {result['name']} twice")
        results[result["name"]] = result
    code = ending_of(lines)
    if code is None:
        raise BenchFailure("the guest's script did not end: its console has no line TEST-RC")
    if code != 0:
        raise BenchFailure(f"the guest's script ended with {code}")
    return results


def ending_of(lines: list[str]) -> int | None:
    """Exit code of the guest's script, None where there is none."""
    codes = [line[len(ENDING) :].strip() for line in lines if line.startswith(ENDING)]
    if len(codes) != 1 or not codes[0].isdecimal():
        return None
    return int(codes[0])
