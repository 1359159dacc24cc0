"""`quiesce identify export MODEL.toml --to c|mat --out FILE`: a model for other programs."""

import argparse
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.cli.identify.help import fill
from quiesce.damper.export.c_names import CSource, c_name
from quiesce.damper.export.kernel_c import kernel_source
from quiesce.damper.export.learned_c import learned_source
from quiesce.damper.export.mat import mat_bytes
from quiesce.damper.model_file import DamperModel, read_model

NAME = "export"
HELP = "a model file as C or MAT"
ENDINGS = {"c": (".c", ".cpp", ".h"), "mat": (".mat",)}
EPILOG = """--to c writes two files, FILE.h and the source. A model of equations becomes C++17
(.cpp) that any such compiler builds and C calls: it holds the library's own text, the numbers and
the integration. Learned models without memory (anfis, feed_forward_network, support_vector) become
plain C11 (.c). Functions and types begin with the file's name. The coil's lag and the field law
are part of it; mass, skew, offset and drift of the rig only with --with-rig.

--to mat writes one struct `damper` with parameters, units, laws, rig and validity; any model.

examples:
  quiesce identify export damper.toml --to c --out my_damper
  quiesce identify export damper.toml --to mat --out damper.mat
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    fill(parser, EPILOG)
    parser.add_argument("model", type=Path, metavar="MODEL.toml", help="damper file")
    parser.add_argument("--to", required=True, choices=sorted(ENDINGS), help="form")
    parser.add_argument("--out", required=True, type=Path, metavar="FILE", help="file to write")
    parser.add_argument(
        "--with-rig", action="store_true", help="with mass, skew, offset and drift of the rig"
    )


def run(args: argparse.Namespace) -> int:
    if not args.model.is_file():
        raise UsageError(f"{shown(args.model)}: no such file; name a damper file (TOML)")
    damper = read_model(args.model)
    files = files_of(damper, args.to, args.out, args.with_rig)
    with output_files(args.out.parent) as staging:
        for name, data in files.items():
            (staging / name).write_bytes(data)
    for name in files:
        print(f"written: {shown(args.out.parent / name)}")
    return 0


def files_of(damper: DamperModel, to: str, out: Path, with_rig: bool) -> dict[str, bytes]:
    """Names and contents. UsageError where model or name do not allow it."""
    if out.suffix and out.suffix.lower() not in ENDINGS[to]:
        raise UsageError(f"--out {out}: --to {to} writes {' or '.join(ENDINGS[to])}; name it so")
    if damper.thermal:
        raise UsageError(
            f"{damper.name} warms up ([thermal]), which no export does; take the table out"
        )
    stem = out.stem if out.suffix else out.name
    if to == "mat":
        return {f"{stem}.mat": mat_bytes(damper)}
    name = c_name(stem)
    if damper.valid.get("usable") is False:
        raise UsageError(
            f"{damper.name} is marked as not usable: {damper.valid.get('reason', 'no reason')}; "
            "choose another parameter set"
        )
    source = c_source(name, damper, with_rig)
    return {f"{name}.h": source.header.encode(), f"{name}{source.ending}": source.source.encode()}


def c_source(name: str, damper: DamperModel, with_rig: bool = False) -> CSource:
    if damper.is_kernel:
        return kernel_source(name, damper, with_rig)
    return learned_source(name, damper, with_rig)
