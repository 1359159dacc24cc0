"""`quiesce identify`: damper models from a test rig's recordings, and what one does with them."""

import argparse
import json
import math
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from quiesce.base.command import finite_number
from quiesce.base.errors import EXIT_INTERRUPTED, UsageError
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.base.searches.names import NAMES as SEARCHES
from quiesce.cli.file_format import add_format, require_format
from quiesce.cli.identify import compare, example, export, inverse, online
from quiesce.cli.identify import plan as cli_plan
from quiesce.cli.identify.data_options import add_data_options
from quiesce.cli.terminal import show

NAME = "identify"
RUNS = "runs"  # folder of the forces of each test
# Each has NAME, HELP, add_options(parser) and run(args).
ACTIONS: tuple[ModuleType, ...] = (cli_plan, example, compare, online, inverse, export)

EPILOG = """also:
{actions}
  ('quiesce identify ACTION --help' has the options of one)

examples:
  quiesce identify example --out example.csv
  quiesce identify example.csv --model quick
  quiesce identify rig.csv --model all --train time_s=0,6 --test time_s=6,12
  quiesce identify low.csv high.csv --current-a 0,1 --model kwok_tanh,viscoplastic_2
  quiesce identify rig.csv --fix n=2 --bound 'rho_1_m=1000:5000' --model normalised_bouc_wen

Writes report.html, report.json and models/NAME.toml for every model; plants read such a file
([damper] file = "..."), so do 'tune' and the actions above. damper.toml is the best passive one of
the run.
--model takes names, 'quick' (static models and small networks), 'parametric', or 'all'.
Models are printed and written as they come, damper.toml with each that is better.
Errors are ||F - F_model|| / ||F|| with the model running free; the ranking goes by validation
inside the training part: whole currents, motions and amplitudes are left out in turn. Ctrl-C keeps
the models that are finished; --resume goes on from there.
"""


def words_of(arguments: Sequence[str]) -> list[str]:
    """`identify ACTION ...` as the one word that the parser knows."""
    words = list(arguments)
    names = [action.NAME for action in ACTIONS]
    if len(words) >= 2 and words[0] == NAME and words[1] in names:
        return [f"{NAME}-{words[1]}", *words[2:]]
    return words


def add_parser(commands: argparse._SubParsersAction) -> None:
    listed = "\n".join(f"  quiesce identify {one.NAME:9s} {one.HELP}" for one in ACTIONS)
    parser = commands.add_parser(
        NAME,
        description="Fit damper models to recordings of motion, force and current; rank them.",
        epilog=EPILOG.format(actions=listed),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("files", type=Path, nargs="*", metavar="DATA.csv")
    add_fit_options(parser.add_argument_group("what to fit"))
    add_data_options(parser.add_argument_group("data"))
    parser.set_defaults(run=run)
    for action in ACTIONS:
        one = commands.add_parser(
            f"{NAME}-{action.NAME}", prog=f"quiesce identify {action.NAME}", description=action.HELP
        )
        action.add_options(one)
        one.set_defaults(run=action.run)


def add_fit_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--model", default="quick", metavar="NAMES",
        help="model names with commas, or quick, parametric, all (quick); 'list' prints them",
    )  # fmt: skip
    group.add_argument("--out", type=Path, metavar="DIR", help=f"({results_text('identify/NAME')})")
    add_format(
        group, "measured and modelled forces of each test, which are then written, too", None
    )
    group.add_argument(
        "--fix", action="append", default=[], metavar="NAME=VALUE",
        help="hold a parameter (SI), e.g. n=2 or skew_s=0; repeatable",
    )  # fmt: skip
    group.add_argument(
        "--bound", action="append", default=[], metavar="NAME=LOW:HIGH",
        help="bounds of a parameter (SI); repeatable",
    )  # fmt: skip
    group.add_argument(
        "--rig", metavar="NAMES",
        help="what around the damper is fitted, with commas, or none: rise_s, fall_s (coil lag), "
        "inertia_kg, skew_s, offset_N, drift_N_s (chosen by the data)",
    )  # fmt: skip
    group.add_argument(
        "--rig-mass-kg", metavar="LOW:HIGH",
        help="mass that moves between damper and force sensor, as far as it is known (0 up to what "
        "weighs a tenth of the largest force)",
    )  # fmt: skip
    group.add_argument(
        "--current-order", type=int, choices=(0, 1, 2), default=2,
        help="highest power of the current in a parameter (%(default)s)",
    )  # fmt: skip
    group.add_argument(
        "--method", choices=("default", "ga", "ga-plain", "de", *SEARCHES, "ls"), default="default",
        help="default: variable projection, differential evolution, least squares; ga: the binary "
        "genetic algorithm of the squeeze-mode paper, in ranges that narrow; ga-plain: in ranges "
        "that do not; de: the thesis' differential evolution; pso, cmaes, es, cuckoo, bees: "
        "searches that a review names; ls: Bouc-Wen by least squares "
        "from three sines a current",
    )  # fmt: skip
    group.add_argument(
        "--time-limit",
        type=finite_number,
        default=300.0,
        metavar="s",
        help="for each model; one that is cut short is ranked with its best so far (%(default)g)",
    )
    group.add_argument(
        "--effort", choices=("quick", "full"), default="full",
        help="quick: fewer starts, networks trained briefly; the same models (%(default)s)",
    )  # fmt: skip
    group.add_argument("--seed", type=int, default=1, help="(%(default)s)")
    group.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="threads (%(default)s)"
    )
    group.add_argument("--resume", action="store_true", help="keep what DIR holds already")
    group.add_argument("--json", action="store_true", help="print the report as one JSON object")


def numbers_of(option: str, words: Sequence[str], count: int) -> dict[str, Any]:
    """NAME=A or NAME=A:B."""
    out: dict[str, Any] = {}
    for word in words:
        name, _, text = word.partition("=")
        try:
            values = [float(part) for part in text.split(":")]
        except ValueError:
            values = []
        if not name or len(values) != count or not all(map(math.isfinite, values)):
            shape = "NAME=VALUE" if count == 1 else "NAME=LOW:HIGH"
            raise UsageError(f"{option} '{word}': write {shape}, numbers in SI units")
        out[name] = values[0] if count == 1 else (values[0], values[1])
    return out


def choice_of(args: argparse.Namespace) -> Any:
    from quiesce.damper.candidates import Choice
    from quiesce.damper.library import RIG, models

    fixed = numbers_of("--fix", args.fix, 1)
    bounds = numbers_of("--bound", args.bound, 2)
    if args.rig_mass_kg is not None:
        mass = mass_of(args.rig_mass_kg)
        if "inertia_kg" in {**fixed, **bounds}:
            raise UsageError("--rig-mass-kg and --fix or --bound inertia_kg say the same; keep one")
        bounds["inertia_kg"] = mass
    known = {one.name for each in models().values() for one in each.parameters} | set(RIG)
    for option, names in (("--fix", fixed), ("--bound", bounds)):
        for name in names:
            if name not in known:
                raise UsageError(
                    f"{option} {name}: no model has such a parameter; see --model list"
                )
    rig = None
    if args.rig is not None:
        rig = tuple(word for word in args.rig.split(",") if word and word != "none")
        for name in rig:
            if name not in RIG[:-1]:  # the last, a reference, follows from the data
                raise UsageError(f"--rig {name}: expected some of {', '.join(RIG[:-1])}, or none")
    return Choice(fixed, bounds, rig, args.current_order + 1, args.method)


def mass_of(text: str) -> tuple[float, float]:
    """Bounds of the rig's mass."""
    low, _, high = text.partition(":")
    try:
        mass = (float(low), float(high))
    except ValueError:
        mass = (math.nan, math.nan)
    if not 0.0 <= mass[0] < mass[1] < math.inf:
        raise UsageError(
            f"--rig-mass-kg {text}: write LOW:HIGH in kg, from 0 on, the first below the second"
        )
    return mass


def print_models() -> None:
    from quiesce.damper.candidates import all_names
    from quiesce.damper.library import models

    for name, one in models().items():
        print(f"{name}: {one.title} ({one.source})")
        for parameter in one.parameters:
            print(f"    {parameter.name:14s} {parameter.unit:10s} {parameter.text}")
    print("others: " + ", ".join(name for name in all_names() if name not in models()))


def check_numbers(args: argparse.Namespace) -> None:
    if not args.time_limit > 0.0:
        raise UsageError("--time-limit has to be above 0")
    if args.seed < 0:
        raise UsageError("--seed has to be 0 or more")
    if not args.files:
        raise UsageError("no recording: name a CSV file, or try 'quiesce identify example'")
    if args.jobs < 1:
        raise UsageError("--jobs has to be 1 or more")


def run(args: argparse.Namespace) -> int:
    from quiesce.cli.identify.data_options import records_of
    from quiesce.damper.candidates import names_of
    from quiesce.damper.data.split import split_records
    from quiesce.damper.store import Store, stamp_of
    from quiesce.damper.task import Plan

    if args.model == "list":
        print_models()
        return 0
    check_numbers(args)
    require_format(args)
    names, choice = names_of(args.model), choice_of(args)
    data = records_of(args)
    for text in data.suspect:  # before minutes of fitting
        print(f"quiesce: {text}", file=sys.stderr, flush=True)
    train, test = split_records(data.records, data.split)
    out = args.out or results_folder() / NAME / args.files[0].stem
    stamp = stamp_of(train, test, (choice, args.seed, args.effort, args.time_limit))
    store = Store(out, stamp, names)
    done = store.finished(names, train, test) if args.resume else []
    plan = Plan(
        names,
        choice,
        args.seed,
        args.time_limit,
        args.effort == "quick",
        args.jobs,
        {"data": [file.name for file in args.files], "command": "quiesce identify"},
    )
    if args.method == "ls":
        fitted = [by_least_squares(train, test, plan, store)]
    else:
        fitted = fit_all(train, test, plan, done, store)
    return report(args, store, fitted, train, test, data.notes)


def by_least_squares(train: Any, test: Any, plan: Any, store: Any) -> Any:
    from quiesce.damper.closed_form import closed_form

    fitted = closed_form(train, test, plan)
    start_folder(store, [])
    store.keep(fitted)
    return fitted


def start_folder(store: Any, done: Sequence[Any]) -> None:
    """damper.toml and runs/ of an earlier run go, but for what `done` makes of them."""
    from quiesce.damper.report.run_files import clear_runs

    store.keep_best(done)
    if not done:
        clear_runs(store.out / RUNS)


def fit_all(train: Any, test: Any, plan: Any, done: Any, store: Any) -> list[Any]:
    """Models as they come, each kept at once. Ctrl-C ends the process there and then."""
    import threading

    from quiesce.base.progress import Progress
    from quiesce.damper.identify import identify
    from quiesce.damper.ranking import ranked

    start_folder(store, done)
    progress = Progress(len(plan.names) - len(done))
    results: list[Any] = []
    failure: list[BaseException] = []
    kept = [one.name for one in done]
    so_far = list(done)
    keeping = threading.Lock()

    def told(one: Any) -> None:
        with keeping:
            store.keep(one)
            kept.extend([one.name] if one.is_complete else [])
            so_far.append(one)
            store.keep_best(so_far)
            is_first = ranked(so_far)[0] is one
        note = "" if one.is_complete else ", not to its end"
        note += ", the best so far" if is_first else ""
        progress.done(f"{one.name}: validation {100 * one.validation_error:.2f} %{note}")

    def say(text: str) -> None:
        print(f"      {text}", file=sys.stderr, flush=True)

    def work() -> None:
        try:
            results.extend(identify(train, test, plan, done, told, say))
        except BaseException as error:  # handed on to the main thread
            failure.append(error)
        finally:
            finished.set()

    finished = threading.Event()
    threading.Thread(target=work).start()
    # Not join: one that Ctrl-C interrupts may take the thread for ended.
    try:
        while not finished.is_set():
            finished.wait(0.2)
    except KeyboardInterrupt:
        with keeping:  # no file is half written
            print(f"quiesce: {interrupted(kept, plan.names)}", file=sys.stderr, flush=True)
            os._exit(EXIT_INTERRUPTED)  # a step of a fit takes seconds
    if failure:
        raise failure[0]
    return results


def interrupted(kept: Sequence[str], asked: Sequence[str]) -> str:
    if not kept:
        return "interrupted; no model was finished"
    told = f"interrupted; {len(kept)} of {len(asked)} models are finished and kept"
    return f"{told}: --resume goes on, --resume --model {','.join(kept)} reports them"


def report(
    args: argparse.Namespace,
    store: Any,
    fitted: Sequence[Any],
    train: Any,
    test: Any,
    notes: Sequence[str],
) -> int:
    from quiesce.damper.ranking import ranked
    from quiesce.damper.report.page import write_report
    from quiesce.damper.report.run_files import write_runs
    from quiesce.damper.report.runs import runs_of, shown_part, whiteness_of
    from quiesce.damper.report.tables import json_report, text_report
    from quiesce.damper.report.where import sentences
    from quiesce.damper.simulate import simulator
    from quiesce.damper.store import BEST

    runs = shown_part(runs_of(simulator(ranked(fitted)[0].damper), train, test))
    white = whiteness_of(runs)
    where = sentences(runs) if all(run.is_finite for run in runs) else []
    context = {"title": args.files[0].stem, "command": "quiesce " + " ".join(sys.argv[1:])}
    write_report(store.out, fitted, train, test, notes, context)
    files = write_runs(store.out / RUNS, fitted, train, test, args.format) if args.format else []
    names = ["report.html", "report.json", "models/"]
    names += [BEST] if store.keep_best(fitted) else []
    names += [f"{RUNS}/{name}" for name in files]
    written = [shown(store.out / name) for name in names]
    if args.json:
        found = json_report(fitted, train, test, notes, context, white, where)
        print(json.dumps({**found, "written": written}))
    else:
        show(text_report(fitted, train, test, notes, white, where))
        print(f"\nwritten    {', '.join(written)}")
    return 0
