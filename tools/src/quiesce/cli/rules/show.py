"""`quiesce rules show FILE`: a rule base as pictures and tables, with a run on top."""

import argparse
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.cli.terminal import show
from quiesce.engine import laws, scenarios
from quiesce.engine.bench import Bench
from quiesce.engine.trace import read_trace
from quiesce.report.page import render
from quiesce.rules.formats.build import NotPlain
from quiesce.rules.formats.files import read_rules, read_system
from quiesce.rules.model import RuleBase
from quiesce.rules.views.plots import file_name, plot_memberships, plot_output, save
from quiesce.rules.views.rule_text import fired_text, rules_text, summary, visits_text
from quiesce.rules.views.subject import Subject, rule_line
from quiesce.rules.views.surface import Slice, make_slice
from quiesce.rules.views.visits import (
    TELEMETRY,
    VALID,
    Fired,
    Visits,
    fired_rules,
    read_visits,
    visits_of_trace,
)

EPILOG = """examples:
  quiesce rules show tools/benchmarks/rules/reference_singleton.fcl
  quiesce rules show my.fis --run build/replay/step_10_20Hz/replay.csv
  quiesce rules show my.fcl --run step_10_20Hz
  quiesce rules show my.fll --run log.csv --column speed=rpm*0.10472 --column load=torque_Nm
  quiesce rules show big.fcl --axes speed,load --at temperature=60
  quiesce rules show smooth.fll

Written: index.html (self-contained), memberships and one surface an output, as PNG and SVG. Of
more than two inputs --axes vary; two others stand at their ends and in their middle, a map each,
but where --at holds them, and the rest in the middle. A file that is no plain rule base (other
norms, smooth sets, hedges, values that depend on inputs) is shown as it is.

--run marks what a run visited and tells which rules fired there, for which share of its rows. It is
a CSV file with a header line, a trace of the bench, or a scenario, which then runs in closed loop
under the shipped fuzzy law. Without --column an input takes the column of its own name; a base of
two inputs without such columns takes the controller's telemetry, freq_uHz in Hz and rms_um_s2 in
m/s2, where freq_is_valid is not 0. Values beyond an input's universe count at its edge.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "show",
        help="sets, surface and rules as pictures and tables",
        description="Draw membership functions and control surface, print the rules, and show\n"
        "which of them a run used.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "file", metavar="FILE", type=Path, help="rule file: .fcl, .fll, .fis or .t2fis"
    )
    parser.add_argument("--run", metavar="RUN", dest="visited", help="CSV file, trace or scenario")
    parser.add_argument(
        "--column", action="append", default=[], metavar="INPUT=COLUMN[*SCALE]",
        help="column of the run for an input, repeatable",
    )  # fmt: skip
    add_reading_options(parser, "two at their ends and in the middle")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help=f"folder to write to ({results_text('rules/show/FILE')})",
    )
    parser.add_argument("--json", action="store_true", help="print the rules and figures as JSON")
    parser.set_defaults(run=run)


def add_reading_options(parser: argparse.ArgumentParser, held: str = "middle") -> None:
    """What to draw of a rule base, and how to read it; held: where inputs are without --at."""
    parser.add_argument(
        "--axes", default="", metavar="NAME[,NAME]", help="inputs that vary (the first two)"
    )
    parser.add_argument(
        "--at", action="append", default=[], metavar="NAME=VALUE",
        help=f"where another input is held, repeatable ({held})",
    )  # fmt: skip
    parser.add_argument(
        "--approximate", type=int, metavar="N",
        help="take a chain of N straight segments for each Gaussian or other smooth set",
    )  # fmt: skip


def read_with_notes(file: Path, approximate: int | None) -> RuleBase:
    """Notes of the reader go to stderr."""
    base = read_rules(file, approximate)
    tell_notes(base, shown(file))
    return base


def tell_notes(base: RuleBase, name: str) -> None:
    for note in base.notes:
        print(f"{name}: {note}", file=sys.stderr)


def read_any(file: Path, approximate: int | None) -> Subject:
    """A plain rule base or a system, with notes."""
    try:
        return read_with_notes(file, approximate)
    except NotPlain as reason:
        if approximate is not None:
            raise
        system = read_system(file)
        print(f"taken: a system of any kind, as {reason}", file=sys.stderr)
        for note in system.notes:
            print(f"{shown(file)}: {note}", file=sys.stderr)
        return system


def slice_of(args: argparse.Namespace, base: Subject) -> Slice:
    return make_slice(base, [name for name in args.axes.split(",") if name], args.at)


def visits_of(args: argparse.Namespace, base: Subject) -> Visits | None:
    if args.visited is None:
        if args.column:
            raise UsageError("--column names columns of a run; add --run FILE")
        return None
    if args.visited.endswith(".toml") or args.visited in scenarios.names():
        if args.column:
            raise UsageError("--column is for a CSV file or a trace; a scenario has its own")
        return run_scenario(base, args.visited)
    return read_visits(base, Path(args.visited), args.column)


def run_scenario(base: Subject, name: str) -> Visits:
    bench = Bench()
    scenario = scenarios.load(bench, name)
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        file = Path(folder) / "trace"
        law = laws.find("fuzzy").bench_law
        bench.call("run", "--scenario", str(scenario.file), "--law", law, "--trace", str(file))
        trace = read_trace(file, [*(column for column, _ in TELEMETRY), VALID])
    return visits_of_trace(base, scenario.name, trace)


def write_files(
    folder: Path, base: Subject, cut: Slice, visits: Visits | None, fired: list[Fired]
) -> None:
    surfaces = [
        (
            output.name,
            save(plot_output(base, i, cut, visits), folder, f"surface_{file_name(output.name)}"),
        )
        for i, output in enumerate(base.outputs)
    ]
    page = render(
        "rules/views/show.html.j2",
        name=base.name,
        summary=summary(base),
        visited=visits and visits_text(base, visits),
        surfaces=surfaces,
        held=cut.page_text(base),
        memberships=save(plot_memberships(base, visits), folder, "memberships"),
        rules=rules_text(base),
        fired=visits and fired_text(base, fired),
    )
    (folder / "index.html").write_text(page, encoding="utf-8")


def json_object(
    args: argparse.Namespace, base: Subject, visits: Visits | None, fired: list[Fired]
) -> dict[str, Any]:
    rules: list[dict[str, Any]] = [
        {"rule": i + 1, "text": rule_line(base, i)} for i in range(len(base.rules))
    ]
    for rule, one in zip(rules, fired, strict=False):
        rule["fired_pct"] = round(100 * one.share, 4)
        rule["strongest_pct"] = round(100 * one.strongest, 4)
        rule["mean_strength"] = round(one.mean_strength, 6)
    run_figures = visits and {
        "name": visits.name,
        "rows": visits.rows,
        "counted": visits.inputs.shape[1],
    }
    return {"file": str(args.file), "name": base.name, "run": run_figures, "rules": rules}


def run(args: argparse.Namespace) -> int:
    base = read_any(args.file, args.approximate)
    cut = slice_of(args, base)
    visits = visits_of(args, base)
    fired = fired_rules(base, visits) if visits is not None else []
    out = args.out or results_folder() / "rules/show" / args.file.stem
    with output_files(out) as staging:
        write_files(staging, base, cut, visits, fired)
        written = sorted(file.name for file in staging.iterdir())
    outputs = [shown(out / name) for name in written]
    if args.json:
        print(json.dumps({**json_object(args, base, visits, fired), "outputs": outputs}, indent=1))
        return 0
    show(f"{summary(base)}\n\n{rules_text(base)}\n")
    if visits is not None:
        show(f"{visits_text(base, visits)}\n\n{fired_text(base, fired)}\n")
    print(f"written  {', '.join(outputs)}")
    return 0
