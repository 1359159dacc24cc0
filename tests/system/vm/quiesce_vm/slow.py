"""The virtual machine's tests on a slow machine: how many runs of them pass with the emulator held
to a share of a core. `python -m quiesce_vm.slow` prints a line for each run, and then the figures.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from dataclasses import asdict, dataclass

from quiesce.base.errors import UsageError
from quiesce.base.paths import root

from quiesce_vm import cpu_share

TESTS = ("tests/system/vm", "--ignore=tests/system/vm/harness_tests")  # those run no emulator
SHARE = 0.25
RUNS = 10
SUMMARY_COLUMNS = "1000"  # or pytest cuts the reasons short


@dataclass(frozen=True)
class SlowRun:
    is_passed: bool
    used_share: float | None  # of a core, by the emulator, as measured; None: no emulator ran
    time_s: float
    said: str  # pytest's reasons, each once, and its last line


def run_once(share: float) -> SlowRun:
    """The tests once, in a process of their own. Passed: no test failed, and the share was kept."""
    start_s = time.monotonic()
    result = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", *TESTS],
        cwd=root(),
        env={**os.environ, cpu_share.VARIABLE: str(share), "COLUMNS": SUMMARY_COLUMNS},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    used = cpu_share.used_share(result.stdout)
    is_held = used is not None and used <= 1.02 * share
    return SlowRun(
        is_passed=result.returncode == 0 and is_held,
        used_share=used,
        time_s=round(time.monotonic() - start_s, 1),
        said=told(result.stdout),
    )


def told(output: str) -> str:
    """The reasons in pytest's summary, each once, and its last line."""
    lines = output.strip().splitlines()
    failures = [
        line.partition(" - ")[2] for line in lines if line.startswith(("FAILED ", "ERROR "))
    ]
    return " | ".join([*dict.fromkeys(failures), lines[-1]])


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="quiesce_vm.slow", description=__doc__)
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--share", type=float, default=SHARE, help="of a core")
    args = parser.parse_args(arguments)
    try:
        cpu_share.share_of(str(args.share))
    except UsageError as error:
        parser.error(str(error))
    passed = 0
    for number in range(1, args.runs + 1):
        run = run_once(args.share)
        passed += run.is_passed
        print(json.dumps({"run": number, **asdict(run)}), flush=True)
    print(json.dumps({"vm_slow_ok": passed, "runs": args.runs, "share": args.share}))
    return 0 if passed == args.runs else 1


if __name__ == "__main__":
    sys.exit(main())
