"""Bytes of the controller's state, as the public header says."""

import shutil
import subprocess
import tempfile
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.paths import root

PROGRAM = """#include "quiesce.h"
#include <stdio.h>
int main(void) { printf("%zu\\n", sizeof(quiesce_t)); return 0; }
"""


def state_bytes(sensors: int, bodies: int, dampers: int) -> int:
    """UsageError where there is no C compiler."""
    compiler = shutil.which("cc")
    if compiler is None:
        raise UsageError("no C compiler 'cc': the size of the state cannot be told")
    sizes = {"SENSORS": sensors, "BODIES": bodies, "DAMPERS": dampers}
    defines = [f"-DQUIESCE_{name}={count}" for name, count in sizes.items()]
    with tempfile.TemporaryDirectory() as folder:
        source, program = Path(folder) / "size.c", Path(folder) / "size"
        source.write_text(PROGRAM, encoding="utf-8")
        headers = f"-I{root() / 'firmware/include'}"
        build = [compiler, "-std=c11", headers, *defines, str(source), "-o", str(program)]
        done = subprocess.run(build, capture_output=True, text=True)
        if done.returncode != 0:
            raise BenchFailure(f"cc: {done.stderr.strip().splitlines()[-1]}")
        return int(subprocess.run([program], capture_output=True, text=True, check=True).stdout)
