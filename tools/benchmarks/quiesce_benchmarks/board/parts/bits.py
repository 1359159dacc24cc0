"""The golden traces on every target: one hash of all that they print."""

import hashlib
import json
import subprocess
from contextlib import closing
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.paths import build_folder, root
from quiesce.base.pools import Threads
from quiesce.base.runner import mapped
from quiesce.base.table import format_table
from quiesce.engine.bench import ending

from quiesce_benchmarks.part import Effort, Measured

TITLE = "bits: the golden traces on every target"
# What each build is, by its preset.
TARGETS = {
    "host": "x86-64",
    "sanitize": "x86-64, clang, sanitizers",
    "m32": "x86, 32 bit",
    "m3": "Cortex-M3",
    "m4f": "Cortex-M4F",
    "m7": "Cortex-M7",
    "m33": "Cortex-M33",
    "rv32": "RISC-V RV32IMAC",
    "aarch64": "AArch64",
}
FIGURES = (("same_bits_targets", "targets", float(len(TARGETS)), "higher"),)
# The program and where what it prints is recorded.
PROGRAMS = {"golden_streams": "golden.txt", "golden_fft": "fft.txt", "golden_guards": "guards.txt"}
# Without the long one.
QUICK = ("golden_fft", "golden_guards")
TIMEOUT_s = 1800
WORKERS = 2


def hash_of(lines: list[str]) -> str:
    return hashlib.sha256("".join(f"{line}\n" for line in lines).encode()).hexdigest()


def recorded_lines(program: str) -> list[str]:
    """Of the recording: streams and guards, not the closed loops of the host."""
    text = (root() / "tests/golden" / PROGRAMS[program]).read_text(encoding="utf-8")
    kinds = ("columns", "streams/", "guards/")
    return [line for line in text.splitlines() if line.startswith(kinds)]


def command_of(preset: str, program: str) -> list[str]:
    """As CTest runs it, with the emulator where there is one. UsageError where it is not built."""
    folder = build_folder() / preset
    if not (folder / "CTestTestfile.cmake").is_file():
        raise UsageError(f"build/{preset} is not there: ./tools/benchmark board builds it")
    asked = ["ctest", "--test-dir", str(folder), "--show-only=json-v1", "-R", f"^{program}$"]
    told = subprocess.run(asked, capture_output=True, text=True, check=True).stdout
    for word in json.loads(told)["tests"][0]["command"]:
        if word.startswith("-DPROGRAM="):
            return [part for part in word.removeprefix("-DPROGRAM=").split(";") if part]
    raise BenchFailure(f"build/{preset}: CTest does not say how {program} runs")


def printed_lines(preset: str, program: str) -> list[str]:
    """What it prints there; QEMU sends an image's text to its standard error."""
    command = command_of(preset, program)
    if not Path(command[-1]).is_file():
        raise UsageError(f"build/{preset} has no {program}: ./tools/benchmark board builds it")
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=TIMEOUT_s
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise BenchFailure(f"{preset}: {program}: {error}") from error
    if done.returncode != 0:
        raise BenchFailure(f"{preset}: {program} ended with {ending(done.returncode)}")
    return (done.stdout + done.stderr).splitlines()


def measure(effort: Effort) -> Measured:
    programs = QUICK if effort.is_quick else tuple(PROGRAMS)
    recorded = hash_of([line for program in programs for line in recorded_lines(program)])

    def hash_on(preset: str) -> str:
        try:
            return hash_of([line for one in programs for line in printed_lines(preset, one)])
        except (BenchFailure, UsageError) as error:
            return str(error)

    with closing(Threads(WORKERS)) as pool:
        found = dict(zip(TARGETS, mapped(pool, hash_on, list(TARGETS)), strict=True))
    rows = [[TARGETS[preset], preset, sha] for preset, sha in found.items()]
    same = sum(sha == recorded for sha in found.values())
    table = format_table(["target", "preset", "SHA-256 of its golden traces"], rows, left=(0, 1, 2))
    reported = {"recorded_sha256": recorded, "sha256": found, "programs": list(programs)}
    return Measured({"same_bits_targets": same}, reported, (table,))
