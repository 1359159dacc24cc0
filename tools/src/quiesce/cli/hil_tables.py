"""Tables of the user's for `quiesce hil`: sources compiled, and who of the run takes which."""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.engine.bench import Bench, setting_options
from quiesce.engine.laws import LAWS, Law
from quiesce.engine.params import effective_params
from quiesce.rules.controller import controller_table
from quiesce.rules.formats.files import FORMATS
from quiesce.table.file import SUFFIX, table_bytes

OPTIONS = ("rules", "pulses", "law_table", "force_map")
TUNED = f".phase{SUFFIX}"


def add_options(parser: argparse.ArgumentParser) -> None:
    for option, metavar, text in (
        ("--rules", "FILE", "for the fuzzy laws: a table, or its source .fis, .fll or .fcl"),
        ("--pulses", "FILE", "for law phase: a table, its law file, or the folder of quiesce tune"),
        ("--law-table", "FILE", "for a law in form of a table"),
        ("--force-map", "FILE", "for the tracker of a law that demands forces"),
    ):
        parser.add_argument(option, type=Path, metavar=metavar, help=text)


def rerun_words(args: argparse.Namespace) -> list[str]:
    """The options again."""
    given = {name.replace("_", "-"): getattr(args, name) for name in OPTIONS}
    return [word for name, file in given.items() if file for word in (f"--{name}", str(file))]


def rules_file(file: Path, folder: Path) -> tuple[Path, list[str]]:
    """The table of rules, compiled into the folder where the file is a source, and what there is to
    say of that."""
    if file.suffix.lower().removeprefix(".") not in FORMATS:
        return file, []
    made = folder / f"rules{SUFFIX}"
    found = controller_table(file)
    made.write_bytes(table_bytes(found.words))
    return made, [f"{shown(file)}: {note}" for note in found.notes]


def say_all(notes: Sequence[str]) -> None:
    for note in notes:
        print(note, file=sys.stderr)


def pulses_file(file: Path, folder: Path) -> tuple[Path, list[str]]:
    """The table of pulses and, of a folder of `quiesce tune`, the parameters that go with it."""
    from quiesce.tune.law import read_settings
    from quiesce.tune.phase_table import read_law
    from quiesce.tune.phase_words import law_words

    if file.is_dir():
        found = sorted(file.glob(f"*{TUNED}"))
        if len(found) != 1:
            raise UsageError(f"--pulses {shown(file)}: {len(found)} files *{TUNED}; name one")
        return found[0], read_settings(file / (found[0].name.removesuffix(TUNED) + ".set"))
    if file.suffix != ".toml":
        return file, []
    made = folder / f"pulses{SUFFIX}"
    made.write_bytes(table_bytes(law_words(read_law(file))))
    return made, []


def table_files(args: argparse.Namespace, folder: Path) -> tuple[dict[str, Path], list[str]]:
    """Tables of one controller by the names of the bench's options, sources compiled into the
    folder, and the parameters that go with them."""
    files = {name: file for name in OPTIONS if (file := getattr(args, name)) is not None}
    settings: list[str] = []
    if "rules" in files:
        files["rules"], notes = rules_file(files["rules"], folder)
        say_all(notes)
    if "pulses" in files:
        files["pulses"], settings = pulses_file(files["pulses"], folder)
    return {name.replace("_", "-"): file for name, file in files.items()}, settings


@dataclass
class Tables:
    """What the runs get."""

    rules: Path | None = None  # the table of the fuzzy laws
    options: dict[str, list[str]] = field(default_factory=dict)  # of the bench, by its name of law
    bare: dict[str, list[str]] = field(default_factory=dict)  # and those without a board

    def add(self, law: str, *options: str) -> None:
        self.options.setdefault(law, []).extend(options)

    def add_pulses(self, law: str, file: Path, settings: Sequence[str]) -> None:
        from quiesce.tune.law import OF_BOARD

        bare = [one for one in settings if one.partition("=")[0] in OF_BOARD]
        rest = [one for one in settings if one not in bare]
        self.add(law, "--pulses", str(file), *setting_options(rest))
        self.bare[law] = setting_options(bare)


def find_tables(
    args: argparse.Namespace, bench: Bench, laws: Sequence[Law], folder: Path
) -> Tables:
    """folder: for files that are made. UsageError where none of the laws takes one of them."""
    tables = Tables()
    if args.rules:
        tables.rules, notes = rules_file(args.rules, folder)
        for law in _takers(bench, laws, "--rules", args.rules, tables.rules):
            tables.add(law, "--rules", str(tables.rules))
        say_all(notes)
    if args.pulses:
        file, settings = pulses_file(args.pulses, folder)
        effective_params(bench, settings)  # refuses bad ones before anything runs
        for law in _takers(bench, laws, "--pulses", args.pulses, file):
            tables.add_pulses(law, file, settings)
    if args.law_table:
        for law in _takers(bench, laws, "--law-table", args.law_table, args.law_table):
            tables.add(law, "--law-table", str(args.law_table))
    if args.force_map:
        _checked(bench, args.force_map, args.force_map)
        for law in _of_forces(laws, args.force_map):
            tables.add(law, "--force-map", str(args.force_map))
    return tables


def _takers(bench: Bench, laws: Sequence[Law], option: str, given: Path, table: Path) -> list[str]:
    """Names in the bench of those laws that take the table."""
    takers = _checked(bench, given, table)["laws"]
    found = sorted({law.bench_law for law in laws} & set(takers))
    if not found:
        whom = f"it is for law {' or '.join(takers)}" if takers else "it is for no law"
        raise UsageError(f"{option} {shown(given)}: {whom}; --law NAME says which laws run")
    return found


def _checked(bench: Bench, given: Path, table: Path) -> dict[str, Any]:
    """What the controller says of a table. UsageError where it refuses it."""
    found = bench.json("table-check", "--file", str(table))
    if found["verdict"] != 0:
        raise UsageError(f"{shown(given)}: the controller refuses the table: {found['reason']}")
    return found


def _of_forces(laws: Sequence[Law], given: Path) -> list[str]:
    """Those that may demand forces: none that is compared by default does."""
    found = sorted({law.bench_law for law in laws} - {law.bench_law for law in LAWS})
    if not found:
        raise UsageError(
            f"--force-map {shown(given)}: no law of the run demands forces; --law NAME says which "
            "laws run"
        )
    return found
