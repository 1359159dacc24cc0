"""`quiesce identify inverse FILE --method NAMES`: inverses made, written, compared."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.command import whole_number
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.base.progress import say
from quiesce.cli.identify.data_options import add_data_options
from quiesce.cli.terminal import show
from quiesce.damper.inverses.methods import METHODS, methods_of
from quiesce.table.file import SUFFIX

SEED = 1


def add_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("methods")
    group.add_argument(
        "--method", metavar="NAMES",
        help=f"make inverses and compare them: {', '.join(METHODS)}, with commas, or all",
    )  # fmt: skip
    group.add_argument(
        "--read", type=Path, action="append", default=[], metavar="FILE",
        help="an inverse made before, compared as well; repeatable",
    )  # fmt: skip
    group.add_argument(
        "--on", type=Path, metavar="MODEL.toml",
        help="damper that they are compared on (the damper file; none for a recording)",
    )  # fmt: skip
    group.add_argument("--seed", type=whole_number(0, (1 << 31) - 1), metavar="N", help=f"({SEED})")
    add_data_options(parser.add_argument_group("data, of a recording"))


def help_lines() -> str:
    """A line for each method."""
    width = max(map(len, METHODS))
    return "".join(f"  {name:{width}}  {one.HELP}\n" for name, one in METHODS.items())


def check_options(args: argparse.Namespace, of_recording: bool) -> None:
    """UsageError for options that nothing would read."""
    file = shown(args.files[0])
    has_methods = bool(args.method or args.read)
    if of_recording and not args.method:
        raise UsageError(
            f"{file}: name a damper file (TOML); with --method an inverse is made from a recording"
        )
    if of_recording and (args.max_speed_m_s or args.amplitude_mm):
        raise UsageError("--max-speed-m-s and --amplitude-mm are for a damper file")
    if not of_recording and (unread := given_data_options(args)):
        raise UsageError(f"{unread[0]}: {file} is a damper file; this is for a recording")
    if not has_methods and (args.on is not None or args.seed is not None):
        raise UsageError("--on and --seed are for --method or --read")


def given_data_options(args: argparse.Namespace) -> list[str]:
    """Data options that the command line has, as they are typed."""
    parser = argparse.ArgumentParser(add_help=False)
    add_data_options(parser.add_argument_group("data"))
    defaults = vars(parser.parse_args([]))
    given = [name for name, value in defaults.items() if getattr(args, name) != value]
    bare = [name.removeprefix("column_").removeprefix("part_") for name in given]
    return [f"--{name.replace('_', '-')}" for name in bare]


def is_recording(files: list[Path]) -> bool:
    """UsageError where recordings and a damper file are mixed, or one is not there."""
    kinds = {file.suffix.lower() != ".toml" for file in files}
    if len(kinds) > 1 or (not any(kinds) and len(files) > 1):
        raise UsageError("name one damper file (.toml), or one or more recordings")
    for file in files:
        if not file.is_file():
            raise UsageError(f"{shown(file)}: no such file; name a damper file or a recording")
    return kinds == {True}


def source_of_damper(damper: Any, simulate: Any, most_A: float, seed: int) -> Any:
    from quiesce.damper.inverses.demand import Source
    from quiesce.damper.inverses.excited import excited

    return Source(excited(damper, simulate, most_A, seed), most_A, damper)


def source_of_recording(args: argparse.Namespace) -> Any:
    from quiesce.cli.identify.data_options import records_of
    from quiesce.damper.data.split import split_records
    from quiesce.damper.inverse import VOLTAGE
    from quiesce.damper.inverses.demand import Source

    data = records_of(args, args.files)
    for one in data.records:
        if one.command_unit != "A":
            raise UsageError(f"{one.name}: {VOLTAGE}")
    train, _ = split_records(data.records, data.split)
    most_A = args.max_current_A or max(float(one.record.command[one.rows].max()) for one in train)
    if not most_A > 0.0:
        raise UsageError("the recording has no current above 0: there is no inverse")
    return Source(train, most_A)


def run(args: argparse.Namespace, damper: Any, simulate: Any, most_A: float) -> int:
    """damper, simulate and most_A: of the damper file; None and 0 for a recording."""
    from quiesce.damper.inverses.made import check_names, made, to_compare
    from quiesce.damper.inverses.tracking import compare
    from quiesce.damper.report.tracking import numbers_of, text_of

    seed = SEED if args.seed is None else args.seed
    methods = methods_of(args.method) if args.method else []
    read = read_all(args.read)
    check_names([*methods, *(one.name for one in read)])
    judge = (damper, simulate) if args.on is None else judge_of(args.on)
    source = source_of_recording(args) if damper is None else None
    if source is None and methods:
        source = source_of_damper(damper, simulate, most_A, seed)
    inverses = made(source, methods, seed, say) + read if methods else read
    found = None
    if judge[0] is not None:
        limit_A = source.max_current_A if source is not None else most_A
        found = compare(*judge, to_compare(inverses), limit_A, seed)
    written = write_all(args, inverses, found) if args.out else []
    if args.json:
        print(json.dumps(numbers_of(inverses, found), indent=1))
        return 0
    show(text_of(inverses, found))
    if found is None:
        print("\nnot compared: a recording is no damper; --on MODEL.toml names one")
    if written:
        print(f"\nwritten: {', '.join(shown(args.out / name) for name in written)}")
    return 0


def judge_of(file: Path) -> tuple[Any, Any]:
    """Damper and its simulation. UsageError where its command is a voltage."""
    from quiesce.damper.inverse import check_amperes
    from quiesce.damper.simulate import simulator_of_file

    damper, simulate = simulator_of_file(file)
    check_amperes(damper)
    return damper, simulate


def read_all(files: list[Path]) -> list[Any]:
    """Inverses by the name of their file, by its path where two have that name."""
    from quiesce.damper.inverses.made import from_file
    from quiesce.damper.inverses.methods import read_inverse

    names = [file.name for file in files]
    out = []
    for file in files:
        method, inverse = read_inverse(file)
        name = file.name if names.count(file.name) == 1 else shown(file)
        out.append(from_file(method, name, inverse))
    return out


def write_all(args: argparse.Namespace, inverses: list[Any], found: Any) -> list[str]:
    """Names of the files in args.out."""
    from quiesce.damper.inverses.methods import bytes_of, file_name
    from quiesce.damper.report.tracking import PAGE, page_of

    made: dict[str, bytes] = {}
    for one in inverses:
        if one.seconds:  # made here
            made[file_name(one.method)] = bytes_of(one.method, one.inverse)
            if one.own_map is not None:
                made[f"map_{one.method}{SUFFIX}"] = one.own_map.to_bytes()
    command = "quiesce " + " ".join(sys.argv[1:])
    page = page_of(args.files[0].stem, inverses, found, list(made), command)
    made[PAGE] = page.encode()
    with output_files(args.out) as staging:
        for name, data in made.items():
            (staging / name).write_bytes(data)
    return list(made)
