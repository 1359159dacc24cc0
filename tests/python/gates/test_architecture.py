"""The dependency rules of the sources hold, and the checker would notice if they did not."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from architecture import call_graph, read_sources, violations
from conftest import ROOT, require

# Where a violation is planted, its line, and what the checker must say.
PLANTED = [
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
    ("firmware/law/law_fuzzy.c", '#include "fuzzy_math.h"', "includes fuzzy_math.h"),
    ("sim_hil/bench/rule_file.cpp", '#include "fuzzy_table.h"', "includes fuzzy_table.h"),
    ("firmware/guard/guard.c", '  #  include "condition.h"', "guard.c includes condition.h"),
    ("firmware/law/law_fuzzy.c", '#include "fuzzy.h"', "law_fuzzy.c includes fuzzy.h"),
    ("firmware/law/law_fuzzy.c", '#include "law_phase.h"', "law_fuzzy.c includes law_phase.h"),
    (
        "firmware/law/phase/law_phase.c",
        '#include "adapt_store.h"',
        "law_phase.c includes adapt_store.h",
    ),
    ("firmware/law/phase/law_phase.c", '#include "lock_in.h"', "law_phase.c includes lock_in.h"),
    ("firmware/law/law.h", '#include "adapt.h"', "law.h includes adapt.h"),
    ("firmware/law/phase/adapt.c", '#include "phase_table.h"', "adapt.c includes phase_table.h"),
    ("firmware/law/phase/phase_table.c", '#include "law.h"', "phase_table.c includes law.h"),
    (
        "firmware/plants/squeeze_2012/generated/plant_pulses.c",
        '#include "phase_table.h"',
        "plant_pulses.c includes phase_table.h",
    ),
    ("firmware/base/harmonics.h", '#include "lock_in.h"', "harmonics.h includes lock_in.h"),
    ("firmware/sense/lock_in.c", '#include "half_cycles.h"', "lock_in.c includes half_cycles.h"),
    ("firmware/chain/controller.c", '#include "app.h"', "controller.c includes app.h"),
    ("firmware/chain/controller.c", '#include "slcan.h"', "controller.c includes slcan.h"),
    ("firmware/app/app.c", '#include "hal_sim.h"', "app.c includes hal_sim.h"),
    ("firmware/app/app.h", '#include "tracker.h"', "app.h includes tracker.h"),
    ("firmware/comm/slcan.c", '#include "lockstep.h"', "slcan.c includes lockstep.h"),
    ("firmware/include/quiesce.h", '#include "guard.h"', "quiesce.h includes guard.h"),
    ("hal/include/hal/accel.h", '#include "quiesce.h"', "accel.h includes quiesce.h"),
    ("hal/sim/hal_sim.c", '#include "supervisor.h"', "hal_sim.c includes supervisor.h"),
    ("sim_hil/bench/run.cpp", '#include "tracker.h"', "run.cpp includes tracker.h"),
    ("sim_hil/bench/run.cpp", '#include "app.h"', "run.cpp includes app.h"),
    ("sim_hil/bench/run.cpp", '#include "../../hal/sim/hal_sim.h"', "hal/sim/hal_sim.h"),
    ("firmware/comm/can_node.h", '#include "node.h"', "can_node.h includes node.h"),
    ("firmware/app/node.h", '#include "gpio.h"', "node.h includes gpio.h"),
    ("hal/linux/gpio.h", '#include "uart_mps2.h"', "gpio.h includes uart_mps2.h"),
    ("targets/linux/quiesced/main.cpp", '#include "tracker.h"', "main.cpp includes tracker.h"),
    ("targets/linux/quiesced/main.cpp", '#include "uart_mps2.h"', "main.cpp includes uart_mps2.h"),
    ("firmware/guard/guard.c", "#include <math.h>", "guard.c includes <math.h>"),
    ("firmware/chain/controller.c", "#include <stdio.h>", "controller.c includes <stdio.h>"),
    ("firmware/sense/rms.c", "static float gain;", "'float': no floating point"),
    ("firmware/app/app.c", "void *p(void) { return malloc(4); }", "'malloc': no heap"),
    ("firmware/base/fixq.c", "int f(int n) {\n    return n ? f(n - 1) : 0;\n}", "f -> f"),
    (
        "firmware/base/fixq.c",
        "int f(int n) {\n    return g(n);\n}\n\nint g(int n) {\n    return f(n);\n}",
        "f -> g -> f",
    ),
]


@pytest.fixture(scope="module")
def clean_copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sources")
    for name in ("firmware", "hal", "linux", "sim_hil"):
        shutil.copytree(ROOT / name, folder / name)
    return folder


def test_architecture_holds() -> None:
    assert violations(ROOT) == []


@pytest.mark.parametrize(("path", "line", "message"), PLANTED)
def test_checker_catches_a_planted_violation(clean_copy, path, line, message) -> None:
    file = clean_copy / path
    original = file.read_text()
    file.write_text(f"{original}\n{line}\n")
    try:
        found = violations(clean_copy)
    finally:
        file.write_text(original)
    assert len(found) == 1, found
    assert message in found[0]


def test_checker_ignores_comments_and_strings(clean_copy) -> None:
    file = clean_copy / "firmware/sense/rms.c"
    original = file.read_text()
    file.write_text(original + '\n// #include "tracker.h" float\n/* malloc */\n')
    try:
        assert violations(clean_copy) == []
    finally:
        file.write_text(original)


def test_checker_sees_the_sources() -> None:
    sources = read_sources(ROOT, "firmware", "hal", "sim_hil")
    assert len(sources) > 80
    controller = next(s for s in sources if s.path == "firmware/chain/controller.c")
    assert {"quiesce.h", "signal_chain.h", "supervisor.h"} <= set(controller.quoted)
    graph = call_graph(ROOT)
    step = graph["firmware/chain/controller.c", "quiesce_step"]
    assert {"signal_chain_step", "guard_step", "supervise"} <= {name for _, name in step}
    chain = graph["firmware/chain/signal_chain.c", "signal_chain_step"]
    assert {"condition_step", "rms_step"} <= {name for _, name in chain}
    assert len(graph) > 100


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
