"""Golden traces: compares or records hashes of what the controller does. ./tools/golden calls it.

`golden.txt` has a line a case: `NAME KIND WORD...`, CRC-32 in hexadecimal.

  streams/NAME  what the program golden_streams prints: random streams through the public header
  loops/NAME    quiesce_bench run: scenario and law in closed loop

Kinds: `in` and `out` have a word a block of 1000 ticks, of what the controller was given (loops)
and of all that it put out; `col` has a word a column of `out` for the whole case, in the order of
the line `columns`.

The plant computes in floating point, and its library functions may round otherwise on another
machine. Where a scenario's input differs although the current is the recorded one (laws off and
constant), it is the plant that differs, and its loops say nothing about the controller.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import zlib
from array import array
from collections.abc import Iterator
from pathlib import Path

RECORDED = Path(__file__).with_name("golden.txt")
BLOCK_TICKS = 1000
INPUTS = ("accel_counts", "flags")
COMMAND = "current_cmd_mA"
# What leaves the controller: the other columns only tell about it.
COMMANDS = ("out_current_cmd_mA", "out_driver_enable", COMMAND)
# Columns that only the report of some laws has, and what they are at rest.
RULES_WORDS = {"rules_fired": 0, "current_fuzzy_mA": 0}
PHASE_WORDS = {
    "adapt_state": 0,
    "adapt_trials": 0,
    "adapt_gains": 0,
    "trim_on_mdeg": 0,
    "trim_off_mdeg": 0,
    "trim_level_q15": 32768,
    "trim_is_whole": 0,
}
LACKING = {
    "fuzzy": PHASE_WORDS,
    "fuzzy_selftune": PHASE_WORDS,
    "phase": RULES_WORDS,
}
# Trials of the adaptation within the few seconds of a scenario.
HASTY = ("adapt_start_ms=300", "adapt_settle_ms=150", "adapt_measure_ms=100")
LAWS = {
    "off": ("off",),
    "constant": ("constant",),
    "fuzzy": ("fuzzy",),
    "fuzzy_selftune": ("fuzzy_selftune", "selftune_polarity=1"),
    "fuzzy_selftune_reversed": ("fuzzy_selftune", "selftune_polarity=-1"),
    "phase_displacement": ("phase", "phase_setting=0"),
    "phase_balanced": ("phase", "phase_setting=1"),
    "phase_displacement_learning": ("phase", "phase_setting=0", *HASTY),
    "phase_balanced_learning": ("phase", "phase_setting=1", *HASTY),
}
# Their current does not depend on what is measured.
OPEN_LAWS = ("off", "constant")
# The same variants of libm's functions on every x86-64: those without fused multiply-add.
PLAIN_LIBM = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"}

Case = dict[str, list[str]]  # words by kind
Cases = dict[str, Case]


class GoldenError(Exception):
    """One line for the user."""


def parse(lines: list[str]) -> tuple[list[str], Cases]:
    """Columns' names, and the cases."""
    columns: list[str] = []
    cases: Cases = {}
    for line in lines:
        name, *words = line.split()
        if name == "columns":
            columns = words
        else:
            cases.setdefault(name, {})[words[0]] = words[1:]
    return columns, cases


def run(command: list[str | Path], **env: str) -> str:
    call = [str(part) for part in command]
    result = subprocess.run(
        call, stdin=subprocess.DEVNULL, capture_output=True, text=True, env={**os.environ, **env}
    )
    if result.returncode != 0:
        detail = (result.stderr.strip().splitlines() or [f"exit code {result.returncode}"])[-1]
        raise GoldenError(f"{Path(call[0]).name}: {detail}")
    return result.stdout


def scenario_files(folder: Path) -> list[Path]:
    """What a bench can run: other tables lie there, too."""
    files = sorted(folder.glob("*.toml"))
    chosen = [file for file in files if 'schema = "quiesce-scenario"' in file.read_text("utf-8")]
    if not chosen:
        raise GoldenError(f"{folder}: no scenarios in it")
    return chosen


def hashes(traces: list[array]) -> str:
    crc = 0
    for values in traces:
        crc = zlib.crc32(values.tobytes(), crc)
    return f"{crc:08X}"


def read_trace(file: Path) -> dict[str, array]:
    """Values by column. All that are asked for are integers, which float64 holds exactly."""
    with file.open("rb") as stream:
        head = json.loads(stream.readline())
        values = array("d", stream.read())
    if sys.byteorder != "little":
        values.byteswap()
    width = len(head["columns"])
    return {name: values[i::width] for i, name in enumerate(head["columns"])}


def with_rest(trace: dict[str, array], rest: dict[str, int]) -> dict[str, array]:
    """The trace with the columns that this law does not have, as they are at rest."""
    ticks = len(trace[INPUTS[0]])
    return trace | {name: array("d", [float(value)]) * ticks for name, value in rest.items()}


def loop_case(trace: dict[str, array], columns: list[str]) -> Case:
    ticks = len(trace[INPUTS[0]])
    starts = range(0, ticks, BLOCK_TICKS)

    def blocks(names: list[str] | tuple[str, ...]) -> list[str]:
        return [hashes([trace[name][at : at + BLOCK_TICKS] for name in names]) for at in starts]

    return {
        "in": blocks(INPUTS),
        "out": blocks(columns),
        "col": [hashes([trace[name]]) for name in columns],
    }


def loop_columns(columns: list[str]) -> list[str]:
    """Those of the telemetry: a trace has no others."""
    return [name for name in columns if not name.startswith("out_")]


def loops(bench: Path, scenarios: Path, columns: list[str]) -> Iterator[tuple[str, Case]]:
    with tempfile.TemporaryDirectory() as folder:
        trace = Path(folder) / "trace"
        for scenario in scenario_files(scenarios):
            for name, (law, *settings) in LAWS.items():
                options = [part for setting in settings for part in ("--set", setting)]
                call = [bench, "run", "--scenario", scenario, "--law", law, *options]
                rest = LACKING.get(law, RULES_WORDS | PHASE_WORDS)
                wanted = ",".join(one for one in (*INPUTS, *columns) if one not in rest)
                run([*call, "--trace", trace, "--columns", wanted], **PLAIN_LIBM)
                values = with_rest(read_trace(trace), rest)
                yield f"loops/{scenario.stem}/{name}", loop_case(values, columns)


def streams(program: Path) -> tuple[list[str], Cases]:
    return parse(run([program]).splitlines())


def differing(recorded: Case, found: Case) -> int:
    """Words of a case that differ; one that is only on one side does."""
    total = 0
    for kind in recorded.keys() | found.keys():
        a, b = recorded.get(kind, []), found.get(kind, [])
        total += sum(x != y for x, y in zip(a, b, strict=False)) + abs(len(a) - len(b))
    return total


def first_block(recorded: Case, found: Case) -> int | None:
    """The first block whose output differs."""
    pairs = zip(recorded.get("out", []), found.get("out", []), strict=False)
    return next((i for i, (x, y) in enumerate(pairs) if x != y), None)


def differing_columns(recorded: Case, found: Case, columns: list[str]) -> list[str]:
    pairs = zip(columns, recorded.get("col", []), found.get("col", []), strict=False)
    return [name for name, x, y in pairs if x != y]


def differing_commands(recorded: Case, found: Case, columns: list[str]) -> int:
    return sum(name in COMMANDS for name in differing_columns(recorded, found, columns))


def columns_of(name: str, columns: list[str]) -> list[str]:
    return columns if name.startswith("streams/") else loop_columns(columns)


def plants_that_differ(recorded: Cases, found: Cases, columns: list[str]) -> set[str]:
    """Scenarios whose input differs under the recorded current."""
    command = loop_columns(columns).index(COMMAND)
    scenarios = set()
    for name in recorded.keys() & found.keys():
        old, new = recorded[name], found[name]
        if name.split("/")[-1] not in OPEN_LAWS or old.get("in") == new.get("in"):
            continue
        if old["col"][command] == new["col"][command]:
            scenarios.add(name.split("/")[1])
    return scenarios


def describe(name: str, recorded: Case, found: Case, columns: list[str]) -> dict[str, object]:
    block = first_block(recorded, found)
    ticks = None if block is None else [block * BLOCK_TICKS, (block + 1) * BLOCK_TICKS - 1]
    names = differing_columns(recorded, found, columns_of(name, columns))
    return {"case": name, "ticks": ticks, "columns": names}


def compare(recorded: Cases, found: Cases, columns: list[str]) -> dict[str, object]:
    plants = plants_that_differ(recorded, found, columns)
    words = differing_words = plant_words = commands = 0
    changed: dict[str, int] = {}
    first = None
    for name in sorted(recorded.keys() | found.keys()):
        old, new = recorded.get(name, {}), found.get(name, {})
        words += sum(len(each) for each in (old or new).values())
        count = differing(old, new)
        if name.startswith("loops/") and name.split("/")[1] in plants:
            plant_words += count
            continue
        differing_words += count
        named = columns_of(name, columns)
        commands += differing_commands(old, new, named)
        for column in differing_columns(old, new, named):
            changed[column] = changed.get(column, 0) + 1
        if count and first is None:
            first = describe(name, old, new, columns)
    return {
        "words": words,
        "differing": differing_words,
        "differing_by_plant": plant_words,
        "differing_commands": commands,
        "cases_by_column": changed,
        "plants": sorted(plants),
        "first": first,
    }


def told(result: dict[str, object]) -> Iterator[str]:
    yield f"golden: {result['differing']} of {result['words']} hash words differ"
    if result["first"]:
        first = result["first"]
        ticks = first["ticks"]
        where = "missing or new" if ticks is None else f"ticks {ticks[0]} .. {ticks[1]}"
        names = first["columns"]
        shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
        yield f"  first: {first['case']}, {where}; columns of this case: {shown or 'none'}"
    if result["cases_by_column"]:
        cases = ", ".join(f"{name} in {n}" for name, n in result["cases_by_column"].items())
        yield f"  cases by column: {cases}; commands: {result['differing_commands']} words"
    if result["plants"]:
        yield (
            f"  {result['differing_by_plant']} more differ where the plant computes other numbers "
            f"under the same current, which is not the controller: {', '.join(result['plants'])}"
        )


def record(args: argparse.Namespace) -> int:
    columns, cases = streams(args.streams)
    cases.update(loops(args.bench, args.scenarios, loop_columns(columns)))
    lines = [f"# Written by ./tools/golden record from commit {args.commit}", ""]
    lines[1] = " ".join(("columns", *columns))
    for name, case in cases.items():
        lines += [" ".join((name, kind, *words)) for kind, words in case.items()]
    unfinished = args.recorded.with_suffix(".part")
    unfinished.write_text("\n".join(lines) + "\n", encoding="utf-8")
    unfinished.replace(args.recorded)
    print(f"golden: {len(cases)} cases written to {args.recorded.name}", file=sys.stderr)
    return 0


def recorded_cases(file: Path) -> tuple[list[str], Cases]:
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise GoldenError(f"{file}: cannot be read: {error.strerror}") from error
    return parse([line for line in lines if line and not line.startswith("#")])


def check(args: argparse.Namespace) -> int:
    columns, recorded = recorded_cases(args.recorded)
    now, found = streams(args.streams)
    if now != columns:
        raise GoldenError("the columns are other ones than the recorded: record anew")
    found.update(loops(args.bench, args.scenarios, loop_columns(columns)))
    result = compare(recorded, found, columns)
    print(json.dumps(result) if args.json else "\n".join(told(result)))
    return 1 if result["differing"] or result["differing_by_plant"] else 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("action", choices=("record", "check"))
    parser.add_argument("--bench", type=Path, required=True, help="quiesce_bench")
    parser.add_argument("--streams", type=Path, required=True, help="golden_streams")
    parser.add_argument("--scenarios", type=Path, required=True, help="folder of scenarios")
    parser.add_argument("--recorded", type=Path, default=RECORDED)
    parser.add_argument("--commit", default="", help="what is recorded")
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    try:
        return record(args) if args.action == "record" else check(args)
    except GoldenError as error:
        print(f"golden: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
