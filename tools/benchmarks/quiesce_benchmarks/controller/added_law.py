"""What it takes to add a law: the example, put into a clone, built and run."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import build_folder, root

from quiesce_benchmarks.house.fresh import fresh_clone

EXAMPLE = "examples/laws/law_constant_force.c"
NAME = "constant_force"
PARAMETERS = "firmware/param/parameters.toml"
LABEL_BEFORE = '    "phase",\n'
# Laws that tracker inverse serves with a map: any damper's will do.
DAMPER = "sim_hil/data/dampers/rd1005_kwok_tanh_smooth.toml"
SCENARIO = "sim_hil/data/scenarios/suspended_mass_step.toml"
GENERATORS = ("tools/gen/params.py",)


def added() -> dict[str, float]:
    """law_added_files, law_added_lines (outside of its own file, generated files apart)."""
    with fresh_clone() as clone:
        add(clone)
        files, lines = difference(clone)
        for script in GENERATORS:
            run([sys.executable, script], clone)
        moved_mA = run_in_bench(clone)
    print(f"controller: law {NAME} built, {moved_mA} different currents", file=sys.stderr)
    if moved_mA < 2:
        raise BenchFailure(f"law {NAME} commands one current all the time")
    return {"law_added_files": files, "law_added_lines": lines}


def add(clone: Path) -> None:
    shutil.copy(clone / EXAMPLE, clone / "firmware/law")
    file = clone / PARAMETERS
    text = file.read_text(encoding="utf-8")
    if text.count(LABEL_BEFORE) != 1:
        raise BenchFailure(f"{PARAMETERS}: the labels of law are written in another way")
    text = text.replace(LABEL_BEFORE, f'{LABEL_BEFORE}    "{NAME}",\n')
    file.write_text(text, encoding="utf-8")


def difference(clone: Path) -> tuple[int, int]:
    """Files that are new, and lines added or taken away in the others."""
    run(["git", "add", "--all"], clone)
    rows = run(["git", "diff", "--cached", "--numstat", "--no-renames"], clone).splitlines()
    status = run(["git", "diff", "--cached", "--name-status", "--no-renames"], clone).splitlines()
    new = {row.split("\t")[1] for row in status if row.startswith("A")}
    lines = [row.split("\t") for row in rows]
    changed = sum(max(int(plus), int(minus)) for plus, minus, name in lines if name not in new)
    return len(new), changed


def run_in_bench(clone: Path) -> int:
    """Builds the bench with it, runs it on a damper's map; how many currents it commanded."""
    build = clone / "build/host"
    # The tests are configured with the rest, and not built.
    run(["cmake", "--preset", "host", f"-DUNITY_DIR={build_folder() / 'deps/unity'}"], clone)
    run(["cmake", "--build", str(build), "--target", "quiesce_bench"], clone)
    made = clone / "map"
    run([root() / "tools/quiesce", "identify", "inverse", DAMPER, "--out", str(made)], clone)
    bench = build / "sim_hil/quiesce_bench"
    case = ["--scenario", SCENARIO, "--law", NAME, "--force-map", str(made / "map.table")]
    return int(json.loads(run([bench, "run", *case], clone))["distinct_commands"])


def run(command: list[str | Path], folder: Path) -> str:
    """What it printed; BenchFailure where it failed."""
    cache = {"CMAKE_C_COMPILER_LAUNCHER": "ccache", "CMAKE_CXX_COMPILER_LAUNCHER": "ccache"}
    environment = {**os.environ, **(cache if shutil.which("ccache") else {})}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        last = (done.stderr.strip() or done.stdout.strip() or "it said nothing").splitlines()[-1]
        raise BenchFailure(f"{Path(str(command[0])).name}: {last}")
    return done.stdout
