"""`quiesce hil` with tables of the user's: sources and tables, on every target, and bad ones."""

import json
from pathlib import Path

import pytest
from conftest import ROOT, require, run_quiesce
from quiesce.engine.bench import Bench
from quiesce.engine.params import parameters
from quiesce.law.forms.friction import FrictionSection, FrictionTable
from quiesce.rules.formats.files import read_rules
from quiesce.rules.formats.write_fis import fis_text
from quiesce.rules.integers.controller import controller_file
from quiesce.table.file import table_bytes
from quiesce.table.kinds import MAP
from quiesce.table.words import sealed
from quiesce.tune.phase_table import read_law
from quiesce.tune.phase_words import law_words

PLANT = ROOT / "firmware/plants/squeeze_2012"
SCENARIO = ROOT / "sim_hil/data/scenarios/sine_5Hz.toml"
RIG = ROOT / "sim_hil/data/rigs/two_storeys.toml"
QUICK = ["--quick", "--scenario", SCENARIO]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Rules and pulses of other currents than those that ship."""
    folder = tmp_path_factory.mktemp("tables")
    text = fis_text(read_rules(PLANT / "rules.fcl"))
    text = text.replace("'constant',[0]", "'constant',[1]")
    (folder / "mine.fis").write_text(text)
    law = (PLANT / "pulses.phase.toml").read_text().replace("level_mA = 5000", "level_mA = 4000")
    (folder / "tuned").mkdir()
    (folder / "tuned/mine.phase.toml").write_text(law)
    words = law_words(read_law(folder / "tuned/mine.phase.toml"))
    (folder / "tuned/mine.phase.table").write_bytes(table_bytes(words))
    (folder / "tuned/mine.set").write_text("--set law=phase --set slew_mA_s=20000\n")
    return folder


def law_files(folder: Path) -> list[str | Path]:
    friction = FrictionTable([FrictionSection(5000, 100_000, 30_000, 200, 3)])
    (folder / "law.table").write_bytes(table_bytes(friction.words()))
    of_damper = [1, 4, 2, 2, -1000, 1000, 0, 2000, -1, -1000, 1, 1000]
    (folder / "map.table").write_bytes(table_bytes(sealed(MAP.magic, of_damper)))
    return [
        "--law", "friction", "--law-table", folder / "law.table",
        "--force-map", folder / "map.table", "--set", "tracker=inverse",
    ]  # fmt: skip


def details(folder: Path, *options: str | Path) -> dict:
    result = run_quiesce(folder, "hil", *options, "--out", "report")
    assert result.returncode == 0, result.stderr
    return json.loads((folder / "report/details.json").read_text())


def digests(found: dict) -> dict[tuple[str, str], int]:
    return {(run["law"], run["target"]): run["telemetry_crc32"] for run in found["runs"]}


# What reaches the controller


def test_rules_are_compiled_as_rules_compile_does(build: Path, folder: Path, monkeypatch) -> None:
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    options = [*QUICK, "--law", "fuzzy", "--target", "host"]
    of_source = digests(details(folder, *options, "--rules", folder / "mine.fis"))
    table = folder / "mine.table"
    table.write_bytes(controller_file(read_rules(folder / "mine.fis")))
    assert digests(details(folder, *options, "--rules", table)) == of_source
    assert digests(details(folder, *options)) != of_source
    run = Bench().json("run", "--scenario", str(SCENARIO), "--law", "fuzzy", "--rules", str(table))
    assert of_source["fuzzy", "host"] == run["telemetry_crc32"]
    page = (folder / "report/index.html").read_text()
    assert "--rules" not in page  # of the last report, which is without


def test_page_says_how_to_run_it_again(build: Path, folder: Path) -> None:
    details(folder, *QUICK, "--law", "fuzzy", "--target", "host", "--rules", "mine.fis")
    assert "--rules mine.fis" in (folder / "report/index.html").read_text()


def test_pulses_come_from_law_file_table_or_folder(build: Path, folder: Path) -> None:
    options = [*QUICK, "--law", "phase", "--target", "host"]
    tuned = folder / "tuned"
    of_file = digests(details(folder, *options, "--pulses", tuned / "mine.phase.toml"))
    assert digests(details(folder, *options, "--pulses", tuned / "mine.phase.table")) == of_file
    assert digests(details(folder, *options)) != of_file
    settings = ["--set", "slew_mA_s=20000"]
    limited = digests(details(folder, *options, "--pulses", tuned))
    of_settings = details(folder, *options, "--pulses", tuned / "mine.phase.toml", *settings)
    assert limited["phase", "host"] == digests(of_settings)["phase", "host"]
    assert limited["phase", "host"] != of_file["phase", "host"]
    # What the user sets counts.
    default = next(one["default"] for one in parameters() if one["name"] == "slew_mA_s")
    own = details(folder, *options, "--pulses", tuned, "--set", f"slew_mA_s={default}")
    assert digests(own)["phase", "host"] == of_file["phase", "host"]


def test_what_a_board_says_is_left_out_of_a_folders_parameters(build: Path, folder: Path) -> None:
    """quiesce tune writes the coil's lag for a controller without a board."""
    tuned = folder / "of_rig"
    tuned.mkdir()
    (tuned / "mine.phase.table").write_bytes((folder / "tuned/mine.phase.table").read_bytes())
    (tuned / "mine.set").write_text("--set law=phase --set current_lag_ms=10\n")
    options = ["--quick", "--scenario", RIG, "--law", "phase", "--target", "host"]
    found = details(folder, *options, "--pulses", tuned)
    assert digests(found) == digests(
        details(folder, *options, "--pulses", folder / "tuned/mine.phase.table")
    )


def test_each_law_has_its_own_table(build: Path, folder: Path) -> None:
    tables = ["--rules", folder / "mine.fis", "--pulses", folder / "tuned/mine.phase.toml"]
    options = [*QUICK, "--target", "host", "--law", "fuzzy", "--law", "phase"]
    both, plain = digests(details(folder, *options, *tables)), digests(details(folder, *options))
    assert both["open_loop", "host"] == plain["open_loop", "host"]
    assert both["fuzzy", "host"] != plain["fuzzy", "host"]
    assert both["phase", "host"] != plain["phase", "host"]


# Every target


@pytest.fixture(params=["mps2", "mps2-uart", "linux"])
def target(request, build: Path, image: Path) -> str:
    require(build / "host/targets/linux/quiesced/quiesced")
    require(image.with_name("quiesce_mps2_uart_8x4.elf"))
    return request.param


def assert_as_on_the_host(found: dict, on_host: dict, target: str) -> None:
    host = digests(on_host)
    there = {law: crc for (law, at), crc in digests(found).items() if at == target}
    assert there and all(crc == host[law, "host"] for law, crc in there.items())
    equal = found["trace_equal"]
    assert equal["mismatches"] == 0 and equal["targets"] == ["host", target]
    assert equal["distinct_commands"] > 10


@pytest.mark.slow
def test_rules_and_pulses_on_each_target(target: str, folder: Path) -> None:
    tables = ["--rules", folder / "mine.fis", "--pulses", folder / "tuned"]
    options = [*QUICK, "--law", "fuzzy", "--law", "phase", *tables]
    on_host = details(folder, *options, "--target", "host")
    assert_as_on_the_host(details(folder, *options, "--target", target), on_host, target)


@pytest.mark.slow
def test_law_table_and_map_on_each_target(target: str, folder: Path) -> None:
    options = ["--quick", "--scenario", RIG, *law_files(folder)]
    on_host = details(folder, *options, "--target", "host")
    found = details(folder, *options, "--target", target)
    assert_as_on_the_host(found, on_host, target)
    assert found["trace_equal"]["case"].startswith("two_storeys, friction")


# Bad input


def damaged(folder: Path) -> Path:
    data = bytearray(controller_file(read_rules(PLANT / "rules.fcl")))
    data[-1] ^= 1
    (folder / "damaged.table").write_bytes(data)
    return folder / "damaged.table"


def test_what_no_law_of_the_run_takes_is_refused(refused, folder: Path) -> None:
    quick = [*QUICK, "--target", "host", "--law", "constant_best"]
    message = refused("hil", *quick, "--rules", folder / "mine.fis")
    assert "mine.fis: it is for law fuzzy or fuzzy_selftune; --law NAME says" in message
    message = refused("hil", *quick, "--pulses", folder / "tuned")
    assert "tuned: it is for law phase; --law NAME says" in message
    law_files(folder)
    message = refused("hil", *quick, "--law-table", folder / "law.table")
    assert "law.table: it is for law friction; --law NAME" in message
    message = refused("hil", *quick, "--law-table", folder / "map.table")
    assert "map.table: it is for no law; --law NAME" in message
    message = refused("hil", *quick, "--force-map", folder / "map.table")
    assert "map.table: no law of the run demands forces" in message


def test_bad_tables_are_refused(refused, tmp_path: Path, folder: Path) -> None:
    quick = ["hil", *QUICK, "--target", "host", "--law", "fuzzy", "--law", "phase"]
    assert "its checksum is wrong: it is damaged" in refused(*quick, "--rules", damaged(folder))
    assert "no.table" in refused(*quick, "--rules", "no.table")
    assert "no.fis" in refused(*quick, "--rules", "no.fis")
    (folder / "bad.fis").write_text("[System]\n")
    assert "bad.fis:1:" in refused(*quick, "--rules", folder / "bad.fis")
    one = ROOT / "tests/unit/firmware/rules/one.fcl"
    assert "one has 1 inputs and 1 outputs" in refused(*quick, "--rules", one)
    (folder / "bad.phase.toml").write_text("schema = 1\n")
    assert "bad.phase.toml: " in refused(*quick, "--pulses", folder / "bad.phase.toml")
    message = refused(*quick, "--pulses", folder / "mine.fis")
    assert "not a table file" in message


def test_folders_of_pulses_that_are_none_are_refused(refused, folder: Path) -> None:
    quick = ["hil", *QUICK, "--target", "host", "--law", "phase", "--pulses"]
    other = folder / "other"
    other.mkdir()
    assert "other: 0 files *.phase.table; name one" in refused(*quick, other)
    table = (folder / "tuned/mine.phase.table").read_bytes()
    (other / "a.phase.table").write_bytes(table)
    assert "a.set: No such file or directory; quiesce tune writes it" in refused(*quick, other)
    for text in ("", "max_current_mA=1", "--set max_current_mA", "--set a=1 --put b=2", "\xff"):
        (other / "a.set").write_bytes(text.encode("latin-1"))
        assert "a.set: expected --set NAME=VALUE" in refused(*quick, other)
    (other / "a.set").write_text("--set law=phase --set nothing=1")
    assert "nothing" in refused(*quick, other)
    (other / "b.phase.table").write_bytes(table)
    assert "other: 2 files *.phase.table; name one" in refused(*quick, other)
