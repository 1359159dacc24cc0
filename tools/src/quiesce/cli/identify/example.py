"""`quiesce identify example`: a recording of a known damper to try identification on."""

import argparse
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.cli.identify.help import fill

NAME = "example"
HELP = "a small recording of a known damper, to try it"
EPILOG = """The file holds 24 s at 200 Hz: a sum of sines of up to 8 mm, 0, 0.5 and 1 A in steps of
2 s, 1 % of noise on the force. Beside it goes FILE_truth.toml, the damper that it came from.

examples:
  quiesce identify example --out example.csv
  quiesce identify example.csv
  quiesce identify compare example_truth.toml example.csv
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    fill(parser, EPILOG)
    parser.add_argument(
        "--out", type=Path, default=Path("example.csv"), metavar="FILE.csv",
        help="file to write (%(default)s)",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    from quiesce.damper.example import EXAMPLE, truth_file, write_example

    if args.out.suffix.lower() != ".csv":
        raise UsageError(f"--out {args.out}: the example is a CSV file; name it FILE.csv")
    write_example(args.out)
    print(f"recording: {shown(args.out)} (time_s, disp_mm, force_N, current_A)")
    print(f"truth:     {shown(truth_file(args.out))} ({EXAMPLE.model} with the coil's lag)")
    print(f"next:      quiesce identify {shown(args.out)}")
    return 0
