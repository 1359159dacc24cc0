"""`quiesce hil --target linux`: the real quiesced, in lock-step over ptys."""

import json
import os
import threading
from pathlib import Path

import pytest
from conftest import require, run_quiesce
from quiesce.base.errors import BenchFailure, UsageError
from quiesce.engine.bench import Bench
from quiesce.engine.linux_target import PtyBus, linux_channel, local_quiesced
from quiesce.hil.table import compared_text

SCENARIO = "sim_hil/data/scenarios/sine_5Hz.toml"
ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="session")
def quiesced(build: Path) -> Path:
    """The Linux controller."""
    return require(build / "host/targets/linux/quiesced/quiesced")


@pytest.fixture(scope="module")
def quick(quiesced: Path, tmp_path_factory: pytest.TempPathFactory):
    """One quick run with a quiesced of its own: the process and its folder."""
    folder = tmp_path_factory.mktemp("linux")
    options = ["--target", "linux", "--quick", "--scenario", "sine_5Hz", "--law", "fuzzy"]
    return run_quiesce(folder, "hil", *options, "--out", "report"), folder / "report"


# The run


@pytest.mark.slow
def test_every_reply_equals_the_host(quick) -> None:
    result, folder = quick
    assert result.returncode == 0, result.stderr
    metrics = json.loads((folder / "metrics.json").read_text())
    equal = metrics["trace_equal"]
    assert equal["mismatches"] == 0 and equal["targets"] == ["host", "linux"]
    assert equal["ticks"] >= 10000 and equal["distinct_commands"] >= 1000
    assert metrics["realtime_factor"]["linux"] > 0.0
    by_target = {
        target: [
            {k: v for k, v in run.items() if k != "target"}
            for run in metrics["runs"]
            if run["target"] == target
        ]
        for target in ("host", "linux")
    }
    assert by_target["host"] == by_target["linux"] and len(by_target["linux"]) == 2


@pytest.mark.slow
def test_table_and_page_say_what_was_compared(quick) -> None:
    result, folder = quick
    assert max(len(line) for line in result.stdout.splitlines()) <= 110
    assert "every command, state and fault, and all words every 100 ticks" in result.stdout
    assert "all words that quiesced sent in the runs above: the same" in result.stdout
    page = (folder / "index.html").read_text(encoding="utf-8")
    for words in ("0 mismatches", "quiesced against host", "./tools/hil", "--target linux"):
        assert words in page


@pytest.mark.slow
def test_runs_follow_one_another_on_one_controller(quiesced: Path) -> None:
    bench = Bench()
    scenario = ["--scenario", str(ROOT / SCENARIO)]
    host = {
        law: bench.json("run", *scenario, "--law", law)["telemetry_crc32"]
        for law in ("fuzzy", "constant")
    }
    with local_quiesced(quiesced) as channel:
        for law in ("fuzzy", "constant", "fuzzy"):
            figures = bench.json(
                "run", *scenario, "--law", law, "--target", "linux", "--can", channel
            )
            assert figures["telemetry_crc32"] == host[law]


def test_channel_of_the_user_is_taken_as_it_is() -> None:
    with linux_channel("slcan:tcp:somewhere:1") as channel:
        assert channel == "slcan:tcp:somewhere:1"


def test_controller_that_ends_early_is_named(build: Path) -> None:
    options = ["--scenario", str(ROOT / SCENARIO), "--law", "fuzzy", "--wait-s", "0.5"]
    with (
        pytest.raises(BenchFailure, match=r"quiesced --lockstep ended with exit code 1: it said"),
        local_quiesced(Path("/bin/false")) as channel,
    ):
        Bench().json("run", *options, "--target", "linux", "--can", channel)


def test_silence_is_the_benchs_own_line(build: Path) -> None:
    options = ["--scenario", str(ROOT / SCENARIO), "--law", "fuzzy", "--wait-s", "0.5"]
    with PtyBus() as bus, pytest.raises(UsageError, match="no target answers within 500 ms"):
        Bench().json("run", *options, "--target", "linux", "--can", f"slcan:{bus.paths[0]}")


def test_words_of_what_is_compared() -> None:
    assert compared_text(1) == "every word of every reply"
    assert compared_text(7).endswith("all words every 7 ticks")


# Bad input


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--can", "slcan:/dev/ttyACM0"], "--can goes with --target linux only"),
        (["--target", "host", "--telemetry-every", "9"], "--telemetry-every goes with"),
        (["--target", "linux", "--telemetry-every", "0"], "--telemetry-every"),
        (["--target", "linux", "--telemetry-every", "all"], "--telemetry-every"),
        (["--target", "linux", "--can", "can0"], "--can can0: is no CAN channel"),
        (["--target", "linux", "--can", "slcan:/no/line"], "slcan:/no/line: No such file"),
        (["--target", "linux", "--can", "slcan:tcp:127.0.0.1:1"], "nobody listens there"),
        (["--target", "linux", "--can", "socketcan:nocan9"], "socketcan:nocan9: "),
    ],
)
def test_bad_channels_are_refused(quiesce, tmp_path: Path, options, message: str) -> None:
    result = quiesce("hil", "--quick", "--scenario", "sine_5Hz", "--law", "fuzzy", *options)
    assert result.returncode == 2
    assert result.stderr.splitlines()[-1].startswith("quiesce: ")
    assert message in result.stderr.splitlines()[-1]
    assert "Traceback" not in result.stderr and result.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_missing_program_is_named(refused, build: Path, tmp_path: Path) -> None:
    folder = tmp_path / "build/host/sim_hil"
    folder.mkdir(parents=True)
    (folder / "quiesce_bench").symlink_to(build / "host/sim_hil/quiesce_bench")
    message = refused("hil", "--target", "linux", QUIESCE_BUILD=str(tmp_path / "build"))
    assert "the Linux controller" in message and "is not built; run ./tools/hil" in message


# The ptys that stand for the bus


def open_line(path: str) -> int:
    return os.open(path, os.O_RDWR | os.O_NOCTTY)


def read_exactly(number: int, count: int) -> bytes:
    data = b""
    while len(data) < count:
        data += os.read(number, count - len(data))
    return data


def test_pty_bus_passes_every_byte_both_ways_and_through_a_reopening() -> None:
    every = bytes(range(256))
    with PtyBus() as bus:
        for _ in range(2):
            first, second = (open_line(path) for path in bus.paths)
            os.write(first, every)
            os.write(second, every[::-1])
            assert read_exactly(second, 256) == every
            assert read_exactly(first, 256) == every[::-1]
            os.close(first)
            os.close(second)


def test_pty_bus_loses_nothing_where_the_reader_is_slow() -> None:
    data = bytes(range(256)) * 400
    with PtyBus() as bus:
        first, second = (open_line(path) for path in bus.paths)

        def write() -> None:
            rest = data
            while rest:
                rest = rest[os.write(first, rest) :]

        writer = threading.Thread(target=write)
        writer.start()
        assert read_exactly(second, len(data)) == data
        writer.join()
        os.close(first)
        os.close(second)


def test_pty_bus_closes_while_nobody_reads() -> None:
    with PtyBus() as bus:
        first = open_line(bus.paths[0])
        os.set_blocking(first, False)
        with pytest.raises(BlockingIOError):
            while True:
                os.write(first, bytes(4096))
        os.close(first)
