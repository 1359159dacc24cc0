"""`quiesce identify export MODEL.toml --to FORM --out FILE`: a model for other programs."""

import argparse
import re
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.command import real_number
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.cli.identify.help import fill
from quiesce.damper.export.c_folder import c_folder
from quiesce.damper.export.c_names import c_name
from quiesce.damper.export.mat import mat_bytes
from quiesce.damper.export.modelica import modelica_name, modelica_package
from quiesce.damper.model_file import DamperModel, read_model

NAME = "export"
HELP = "a model file as C, Modelica, MAT or a table for Simulink"
ENDINGS = {"c": (), "lookup": (".mat", ".m"), "mat": (".mat",),
           "modelica": (".mo",)}  # fmt: skip
EPILOG = """--to c writes a folder of plain C11: FOLDER.h, FOLDER.c, a program main.c that holds
them to forces of the bench's own model, CMakeLists.txt and README.md. Functions and types begin
with the folder's name; the caller owns the state. Models of equations give the bench's forces to
the last bit. The coil's lag and the field law are part of it; mass, skew, offset and drift of the
rig only with --with-rig.

--to modelica writes a package FILE.mo that needs no library: Force (x, v, command in, force out),
Damper (between two flanges that fit those of Modelica.Mechanics.Translational) and Example. For
models of equations; the coil's lag and the field law are part of it.

--to mat writes one struct `damper` with parameters, units, laws, rig and validity; any model.

--to lookup writes FILE.mat with force_N over velocity_m_s and current_A, for Simulink's 2-D Lookup
Table, and FILE.m, which says how; any model whose command is a current. It is the force of a closed
loop in mid-stroke: the loop's width, the coil's lag and the rig are not in it.

examples:
  quiesce identify export damper.toml --to c --out my_damper
  quiesce identify export damper.toml --to modelica --out Damper.mo
  quiesce identify export damper.toml --to mat --out damper.mat
  quiesce identify export damper.toml --to lookup --out table.mat --max-current-A 2
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    fill(parser, EPILOG)
    parser.add_argument("model", type=Path, metavar="MODEL.toml", help="damper file")
    parser.add_argument("--to", required=True, choices=sorted(ENDINGS), help="form")
    parser.add_argument(
        "--out", required=True, type=Path, metavar="FILE", help="file to write; of c: a folder"
    )
    parser.add_argument(
        "--with-rig", action="store_true", help="with mass, skew, offset and drift of the rig"
    )
    parser.add_argument(
        "--max-current-A", type=real_number(1e-6, 1e3, "a current in A"), metavar="A",
        help="of lookup: its largest (max_current_A of the file's [valid])",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    if not args.model.is_file():
        raise UsageError(f"{shown(args.model)}: no such file; name a damper file (TOML)")
    damper = read_model(args.model)
    if args.max_current_A is not None and args.to != "lookup":
        raise UsageError("--max-current-A is of --to lookup")
    if args.with_rig and args.to != "c":
        raise UsageError("--with-rig is of --to c")
    require_exportable(damper, args.to, args.out)
    if args.to == "lookup":
        files = lookup_of(args, damper)
    else:
        files = files_of(damper, args.to, args.out, args.with_rig)
    folder = args.out.parent if ENDINGS[args.to] else args.out
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"--out {shown(folder)}: there is a file of this name; name a folder")
    with output_files(folder) as staging:
        for name, data in files.items():
            (staging / name).write_bytes(data)
    for name in files:
        print(f"written: {shown(folder / name)}")
    return 0


def require_exportable(damper: DamperModel, to: str, out: Path) -> None:
    """UsageError where model or name do not allow it."""
    if out.suffix and not ENDINGS[to]:
        raise UsageError(f"--out {out}: --to {to} writes a folder; name it without an ending")
    if out.suffix and out.suffix.lower() not in ENDINGS[to]:
        raise UsageError(f"--out {out}: --to {to} writes {' or '.join(ENDINGS[to])}; name it so")
    if damper.thermal:
        raise UsageError(
            f"{damper.name} warms up ([thermal]), which no export does; take the table out"
        )
    if damper.valid.get("usable") is False:
        raise UsageError(
            f"{damper.name} is marked as not usable: {damper.valid.get('reason', 'no reason')}; "
            "choose another parameter set"
        )


def stem_of(out: Path) -> str:
    return out.stem if out.suffix else out.name


def lookup_of(args: argparse.Namespace, damper: DamperModel) -> dict[str, bytes]:
    """Imports late what is slow to import."""
    from quiesce.cli.identify.inverse import stated_current
    from quiesce.damper.export.lookup import lookup_files
    from quiesce.damper.inverse import check_amperes
    from quiesce.damper.simulate import simulator_of_file

    check_amperes(damper)
    stem = stem_of(args.out)
    if re.fullmatch(r"[A-Za-z]\w*", stem, flags=re.ASCII) is None:
        raise UsageError(
            f"--out: '{stem}' is the name of a MATLAB script; begin it with a letter and use "
            "letters, digits and underscores"
        )
    most_A = args.max_current_A or stated_current(damper)
    return lookup_files(stem, damper, simulator_of_file(args.model)[1], most_A)


def files_of(damper: DamperModel, to: str, out: Path, with_rig: bool) -> dict[str, bytes]:
    """Names and contents. UsageError where model or name do not allow it."""
    if to == "mat":
        return {f"{stem_of(out)}.mat": mat_bytes(damper)}
    if to == "modelica":
        name = modelica_name(stem_of(out))
        return {f"{name}.mo": modelica_package(name, damper).encode()}
    name = c_name(stem_of(out))
    return {file: text.encode() for file, text in c_folder(name, damper, with_rig).items()}
