"""The rules of the sources hold, and the checker would notice if they did not."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT, require
from house import c_violations, import_circles, python_violations, violations
from house.c_rules import call_graph
from house.c_sources import Tree
from house.circles import circles_of
from house.python_sources import Package
from house.rooms import stale_rooms, table, unknown_rooms

# Where a violation is planted, its line, and what the checker must say.
PLANTED_IN_C = [
    ("firmware/base/fixq.h", '#include "rms.h"', "fixq.h includes rms.h"),
    ("firmware/sense/rms.c", '#include "tracker.h"', "rms.c includes tracker.h"),
    ("firmware/sense/rms.c", '#include "hal/accel.h"', "rms.c includes hal/accel.h"),
    ("firmware/fuzzy/fuzzy.h", '#include "law.h"', "fuzzy.h includes law.h"),
    ("firmware/fuzzy/fuzzy_math.h", '#include "fuzzy_table.h"', "includes fuzzy_table.h"),
    ("firmware/fuzzy/fuzzy_table.c", '#include "fuzzy.h"', "fuzzy_table.c includes fuzzy.h"),
    (
        "firmware/plants/squeeze_2012/generated/plant_rules.c",
        '#include "fuzzy_table.h"',
        "plant_rules.c includes fuzzy_table.h",
    ),
    ("firmware/law/rules/rule_base.c", '#include "fuzzy_math.h"', "includes fuzzy_math.h"),
    ("sim_hil/bench/table_file.cpp", '#include "fuzzy_table.h"', "includes fuzzy_table.h"),
    ("firmware/guard/guard.c", '  #  include "condition.h"', "guard.c includes condition.h"),
    ("firmware/law/law_constant.c", '#include "fuzzy.h"', "law_constant.c includes fuzzy.h"),
    ("firmware/law/rules/law_fuzzy.c", '#include "adapt.h"', "law_fuzzy.c includes adapt.h"),
    ("firmware/law/law_off.c", '#include "rule_base.h"', "law_off.c includes rule_base.h"),
    ("firmware/law/phase/law_phase.c", '#include "adapt_effect.h"', "includes adapt_effect.h"),
    ("firmware/law/phase/law_phase.c", '#include "lock_in.h"', "law_phase.c includes lock_in.h"),
    ("firmware/law/phase/adapt.c", '#include "phase_table.h"', "adapt.c includes phase_table.h"),
    (
        "firmware/plants/squeeze_2012/generated/plant_pulses.c",
        '#include "phase_table.h"',
        "plant_pulses.c includes phase_table.h",
    ),
    ("firmware/base/harmonics.h", '#include "lock_in.h"', "harmonics.h includes lock_in.h"),
    ("firmware/sense/lock_in.c", '#include "half_cycles.h"', "lock_in.c includes half_cycles.h"),
    ("firmware/chain/controller.c", '#include "slcan.h"', "controller.c includes slcan.h"),
    ("firmware/comm/slcan.c", '#include "lockstep.h"', "slcan.c includes lockstep.h"),
    ("firmware/comm/can_node.c", '#include "guard.h"', "can_node.c includes guard.h"),
    ("firmware/include/quiesce.h", '#include "guard.h"', "quiesce.h includes guard.h"),
    ("firmware/sense/rms.c", '#include "nowhere.h"', "rms.c includes nowhere.h"),
    ("hal/include/hal/accel.h", '#include "quiesce.h"', "accel.h includes quiesce.h"),
    ("hal/image/stack.c", '#include "supervisor.h"', "stack.c includes supervisor.h"),
    ("hal/records/nvm_records.c", '#include "nvm_mps2.h"', "includes nvm_mps2.h"),
    ("hal/linux/gpio.h", '#include "uart_mps2.h"', "gpio.h includes uart_mps2.h"),
    ("sim_hil/bench/run.cpp", '#include "tracker.h"', "run.cpp includes tracker.h"),
    ("sim_hil/bench/run.cpp", '#include "quiesce.h"', "run.cpp includes quiesce.h"),
    ("sim_hil/bench/run.cpp", '#include "../../hal/mps2/nap.h"', "hal/mps2/nap.h"),
    ("sim_hil/damper/viscous.h", '#include "scenario.h"', "viscous.h includes scenario.h"),
    ("sim_hil/base/noise.h", '#include "plant.h"', "noise.h includes plant.h"),
    ("targets/linux/quiesced/main.cpp", '#include "tracker.h"', "main.cpp includes tracker.h"),
    ("targets/linux/quiesced/main.cpp", '#include "uart_mps2.h"', "main.cpp includes uart_mps2.h"),
    ("sim_hil/bench/run.cpp", "#include <tracker.h>", "run.cpp includes tracker.h"),
    ("hal/image/stack.c", "#include <supervisor.h>", "stack.c includes supervisor.h"),
    ("hal/image/stack.c", "#define H <supervisor.h>\n#include H", "stack.c includes H"),
    (
        "hal/image/stack.c",
        'const char *a = "/*";\n#include "supervisor.h"\nconst char *b = "*/";',
        "stack.c includes supervisor.h",
    ),
    ("firmware/new_block/new.c", "", "new.c is in no room of the table"),
    ("firmware/guard/guard.c", "#include <math.h>", "guard.c includes <math.h>"),
    ("firmware/chain/controller.c", "#include <stdio.h>", "controller.c includes <stdio.h>"),
    ("firmware/sense/rms.c", "static float gain;", "'float': no floating point"),
    ("firmware/comm/can_pack.c", "void *p(void) { return malloc(4); }", "'malloc': no heap"),
    ("firmware/chain/controller.c", "// as squeeze_2012", "names the rig squeeze_2012"),
    ("firmware/base/fixq.c", "int f(int n) {\n    return n ? f(n - 1) : 0;\n}", "fixq.c: f"),
    (
        "firmware/base/fixq.c",
        "int f(int n) {\n    return g(n);\n}\n\nint g(int n) {\n    return f(n);\n}",
        "recursion: firmware/base/fixq.c: f, firmware/base/fixq.c: g",
    ),
    # Circles inside a room: of headers, of C files behind headers, of C++ files behind theirs.
    ("firmware/base/fixq.h", '#include "ldlt.h"', "fixq.h, firmware/base/ldlt.h"),
    (
        "hal/linux/sysfs.c",
        "int32_t f(void) {\n    return current_pwm_close(0);\n}",
        "hal/linux/current_pwm.c, hal/linux/sysfs.c",
    ),
    (
        "sim_hil/scenario/segment_section.cpp",
        '#include "scenario.h"\nScenario again() { return load_scenario("x"); }',
        "sim_hil/scenario/scenario.cpp, sim_hil/scenario/segment_section.cpp",
    ),
]
PLANTED_IN_PYTHON = [
    ("base/errors.py", "import quiesce.engine.bench", "errors.py imports quiesce.engine.bench"),
    (
        "base/errors.py",
        "from quiesce.report import plot_style",
        "imports quiesce.report.plot_style",
    ),
    ("can/mdf.py", "from ..damper import plan", "mdf.py imports quiesce.damper.plan"),
    (
        "signal/resample.py",
        "def f():\n    from quiesce.rules.model import Rule\n    return Rule",
        "resample.py imports quiesce.rules.model",
    ),
    ("tune/plan.py", "x = import_module('quiesce.cli.main')", "plan.py imports quiesce.cli.main"),
    ("tune/plan.py", "x = import_module(f'quiesce.cli.{plan}')", "plan.py imports quiesce.cli"),
    ("tune/plan.py", "x = import_module(plan)", "imports what only the run names"),
    ("tune/plan.py", "x = import_module('.main', 'quiesce.cli')", "imports what only the run"),
    ("tune/plan.py", "x = import_module(f'quiesce.{plan}')", "imports what only the run names"),
    ("tune/plan.py", "runpy.run_module('quiesce.cli.main')", "imports what only the run names"),
    ("hil/runs.py", "from sys import stdout\nstdout.write('done')", "has sys.stdout"),
    ("hil/runs.py", "import quiesce_benchmarks.images", "imports quiesce_benchmarks.images"),
    ("hil/runs.py", "import quiesce_vm.boots", "runs.py imports quiesce_vm.boots"),
    ("hil/runs.py", "import damper_files", "imports tests/python/damper/damper_files"),
    ("newroom/thing.py", "", "newroom/thing.py is in no room"),
    ("hil/runs.py", "print('done')", "has print"),
    ("hil/runs.py", "from argparse import Namespace", "has argparse"),
    ("hil/runs.py", "import sys\nsys.stdout.write('done')", "has sys.stdout"),
    ("hil/runs.py", "FILE = 'sim_hil/data/plants/squeeze_2012.toml'\nFILE", "names the rig"),
    ("hil/runs.py", "def nobody_calls_it():\n    nobody_calls_it()", "nobody_calls_it is named"),
    ("hil/runs.py", "NOBODY_READS_IT = 1", "NOBODY_READS_IT is named nowhere"),
    (
        "recording/units.py",
        "def f():\n    from quiesce.recording.columns import ROLES\n    return ROLES, f",
        "circle of imports: quiesce.recording.columns, quiesce.recording.units",
    ),
]


@pytest.fixture(scope="module")
def tree() -> Tree:
    return Tree(ROOT)


@pytest.fixture(scope="module")
def package() -> Package:
    return Package(ROOT)


def test_architecture_holds() -> None:
    assert violations(ROOT) == []


def test_circles_are_counted_over_the_whole_tree() -> None:
    assert import_circles(ROOT) == []


def with_line(path: str, line: str) -> str:
    file = ROOT / path
    return f"{file.read_text() if file.exists() else ''}\n{line}\n"


@pytest.mark.parametrize(("path", "line", "message"), PLANTED_IN_C)
def test_checker_catches_what_is_planted_in_c(tree, path, line, message) -> None:
    found = c_violations(tree.with_file(path, with_line(path, line)))
    assert any(message in one for one in found), found


@pytest.mark.parametrize(("path", "line", "message"), PLANTED_IN_PYTHON)
def test_checker_catches_what_is_planted_in_python(package, path, line, message) -> None:
    path = f"tools/src/quiesce/{path}"
    found = python_violations(package.with_file(path, with_line(path, line)))
    assert any(message in one for one in found), found


def test_checker_catches_a_fourth_flat_module(package) -> None:
    more = package
    for name in ("one", "two", "three"):
        more = more.with_file(f"tools/src/quiesce/{name}.py", "")
    assert any("modules in the package's root" in one for one in python_violations(more))


@pytest.mark.parametrize(
    "folder", ["track", "firmware/tracks", "tools/src/quiesce/track", "docs/track", "tests/track"]
)
def test_checker_catches_a_folder_that_no_question_leads_to(tmp_path, folder) -> None:
    (tmp_path / "firmware/base/inner").mkdir(parents=True)
    (tmp_path / "build/anything").mkdir(parents=True)
    (tmp_path / folder / "inner").mkdir(parents=True)
    assert list(unknown_rooms(tmp_path)) == [
        f"{folder}/ is no room: no question of rooms.toml leads there"
    ]


def test_every_listed_folder_is_there(tmp_path) -> None:
    assert list(stale_rooms(ROOT)) == []
    assert "rooms.toml lists firmware/base, which is not there" in stale_rooms(tmp_path)


def test_page_shows_the_table_of_rooms(monkeypatch) -> None:
    path = ROOT / "tests/gen/rooms.py"
    spec = importlib.util.spec_from_file_location("rooms_page", path)
    page = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(page)
    shown = page.PAGE.read_text()
    assert page.filled(shown) == shown
    monkeypatch.setitem(table()["python"], "hil", ["cli"])
    assert "| `hil` | `cli` |" in page.filled(shown)


def test_checker_ignores_comments_and_strings(tree) -> None:
    path = "firmware/sense/rms.c"
    raw = with_line(path, '// #include "tracker.h" float\n/* malloc */\n')
    assert c_violations(tree.with_file(path, raw)) == c_violations(tree)


def test_circles_are_found_whole_and_once() -> None:
    graph = {
        "a": {"b"},
        "b": {"c"},
        "c": {"a", "d"},
        "d": {"e"},
        "e": {"d"},
        "f": {"a"},
        "g": {"g"},
    }
    assert circles_of(graph) == [["a", "b", "c"], ["d", "e"], ["g"]]


def test_checker_sees_the_sources(tree, package) -> None:
    assert len(list(tree.below("firmware", "hal", "sim_hil"))) > 250
    assert {"quiesce.h", "signal_chain.h", "supervisor.h"} <= set(
        tree.sources["firmware/chain/controller.c"].quoted
    )
    graph = call_graph(tree)
    step = graph["firmware/chain/controller.c: quiesce_step"]
    called = {callee.split(": ")[1] for callee in step}
    assert {"signal_chain_step", "command", "supervise"} <= called
    assert len(graph) > 100
    assert len(package.modules) > 400
    assert "quiesce.engine.bench" in package.imports["quiesce.hil.runs"]


@pytest.mark.parametrize("generator", sorted(p.name for p in (ROOT / "tools/gen").glob("*.py")))
def test_generated_files_match_their_sources(generator) -> None:
    result = subprocess.run(
        [sys.executable, str(ROOT / "tools/gen" / generator), "--check"],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert result.returncode == 0, result.stdout + result.stderr


def test_firmware_has_no_mutable_globals(build: Path) -> None:
    library = require(build / "mps2/firmware/libquiesce_core.a")
    symbols = subprocess.run(
        ["arm-none-eabi-nm", str(library)], capture_output=True, text=True, check=True
    ).stdout
    rows = [line.split()[-2:] for line in symbols.splitlines() if len(line.split()) >= 2]
    assert ["T", "quiesce_step"] in rows
    assert [name for kind, name in rows if kind in "BbCDd"] == []
