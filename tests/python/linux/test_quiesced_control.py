"""The controller program controls: on a pty that speaks SLCAN, as an adapter does."""

import os
import signal
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from quiesced_peer import PATIENCE_S, Quiesced, on_a_pty, protected, slcan
from quiesced_steps import (
    ESTOP,
    FAULT,
    IDLE,
    RUN,
    SAFE,
    in_a_row,
    preload,
    read_parameter,
    start_running,
)


@pytest.fixture
def quiesced(tmp_path: Path) -> Iterator[Quiesced]:
    with on_a_pty(tmp_path) as under_test:
        yield under_test


def test_reaches_run_and_leaves_with_a_farewell(quiesced: Quiesced) -> None:
    start_running(quiesced)
    quiesced.peer.wait("Status", lambda s: s["state"] == RUN and s["is_enabled"] == 1)
    quiesced.peer.wait("Identification")
    after = quiesced.peer.count()
    assert quiesced.stop() == 0
    last = quiesced.peer.wait("CurrentDemand", lambda s: s["driver_is_enabled"] == 0, after)
    assert last.signals["current_cmd_mA"] == 0  # safe_current_mA
    log = quiesced.log_text()
    assert "safe current, output off" in log
    assert "lateness: " in log
    assert "work: " in log


def test_status_file_on_request(quiesced: Quiesced) -> None:
    start_running(quiesced)
    quiesced.signal(signal.SIGUSR1)
    quiesced.peer.wait("Identification", after=quiesced.peer.count())
    assert quiesced.stop() == 0
    status = quiesced.status()
    assert status["fault"] in ("NONE", "TICK_LOST")
    assert status["can"]["state"] == "up"
    assert status["can"]["rejected_crc"] == 0
    assert status["loop"]["ticks"] == status["loop"]["lateness"]["count"]


def test_operator_withdraws(quiesced: Quiesced) -> None:
    start_running(quiesced)
    after = quiesced.peer.count()
    quiesced.peer.operator = {"enable": 0}
    quiesced.peer.wait_state(IDLE, after)
    after = quiesced.peer.count()
    quiesced.peer.operator = {"enable": 1}
    quiesced.peer.wait_state(RUN, after)
    after = quiesced.peer.count()
    quiesced.peer.operator = None  # no frames any more: not enabled
    quiesced.peer.wait_state(IDLE, after)
    assert quiesced.stop() == 0


def test_emergency_stop_latches_until_it_is_acknowledged(quiesced: Quiesced) -> None:
    start_running(quiesced)
    peer = quiesced.peer
    after = peer.count()
    peer.estop = True
    off = peer.wait_state(FAULT, after)
    assert off.signals["driver_is_enabled"] == 0
    assert off.signals["current_cmd_mA"] == 0
    assert peer.wait("Status", lambda s: s["state"] == FAULT, after).signals["fault"] == ESTOP
    peer.estop = False
    peer.wait_state(FAULT, peer.count())
    after = peer.count()
    peer.acknowledges = True
    peer.wait_state(RUN, after)
    assert quiesced.stop() == 0
    assert "fault ESTOP" in quiesced.log_text()
    assert "ESTOP" in [event["fault"] for event in quiesced.status()["last_faults"]]


def test_lost_sensor_goes_to_the_safe_current_and_recovers(quiesced: Quiesced) -> None:
    quiesced.write_config("law = 'constant'\nsafe_current_mA = 40\n")
    start_running(quiesced)
    peer = quiesced.peer
    after = peer.count()
    peer.feeds_sensor = False
    # A lost tick ends in SAFE, too; without samples there is no way out of it.
    safe = peer.wait("CurrentDemand", in_a_row(1200, SAFE), after)
    assert safe.signals["current_cmd_mA"] == 40
    after = peer.count()
    peer.feeds_sensor = True
    peer.wait_state(RUN, after)
    assert quiesced.stop() == 0
    faults = {event["fault"] for event in quiesced.status()["last_faults"]}
    assert faults & {"SENSOR_LOST", "TICK_LOST"}


def test_hostile_bytes_change_nothing(quiesced: Quiesced) -> None:
    start_running(quiesced)
    peer = quiesced.peer
    peer.send_raw(b"\xff\x00t0104\r" + b"x" * 300 + b"\rt0324\rT\r" + b"t0204DEADBEEF\r")
    peer.wait("CanHealth", lambda s: s["rejected_crc"] == 1, 0)
    assert quiesced.stop() == 0
    assert quiesced.status()["can"]["malformed"] > 0


def test_flood_leaves_control_undisturbed(quiesced: Quiesced) -> None:
    """More than a bus can carry, most of it with a wrong CRC."""
    start_running(quiesced)
    peer = quiesced.peer
    wrong = slcan(*protected("OperatorCommand", enable=0, fault_reset=0, alive=3))[:-2] + b"X\r"
    stale = slcan(*protected("OperatorCommand", enable=0, fault_reset=0, alive=3))
    for _ in range(200):
        peer.send_raw((wrong + stale) * 10)
    peer.wait_state(RUN, peer.count())
    assert read_parameter(peer, "tick_rate_Hz") == 500
    assert quiesced.stop() == 0
    status = quiesced.status()["can"]
    assert status["malformed"] == 2000
    assert status["rejected_alive"] > 0


def test_second_instance_is_refused(quiesced: Quiesced) -> None:
    start_running(quiesced)
    assert quiesced.process is not None
    result = quiesced.run()
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert f"process {quiesced.process.pid} holds" in result.stderr
    assert quiesced.run("--make-safe").returncode == 1  # it leaves a live controller alone
    peer = quiesced.peer
    peer.wait_state(RUN, peer.count())
    assert quiesced.stop() == 0


def test_ends_after_ticks(quiesced: Quiesced) -> None:
    quiesced.start("--ticks", "700")
    assert quiesced.wait() == 0
    assert quiesced.status()["loop"]["ticks"] == 700
    assert quiesced.status()["tick"] == 700 + quiesced.status()["loop"]["overruns"]


COUNTER = r"""
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);
static long count;
static void note(void) { count += gettid() == getpid(); }
void *malloc(size_t n) { note(); return __libc_malloc(n); }
void *calloc(size_t n, size_t size) { note(); return __libc_calloc(n, size); }
void *realloc(void *p, size_t n) { note(); return __libc_realloc(p, n); }
__attribute__((destructor)) static void tell(void) {
    FILE *out = fopen(getenv("COUNTER_FILE"), "w");
    fprintf(out, "%ld", count);
    fclose(out);
}
"""


@pytest.mark.slow
def test_the_loop_allocates_nothing(quiesced: Quiesced, tmp_path: Path) -> None:
    """However long it runs, its thread has asked for memory equally often."""
    counts = tmp_path / "count"
    library = preload(tmp_path, "counter", COUNTER)
    environment = {**os.environ, "LD_PRELOAD": library, "COUNTER_FILE": str(counts)}
    asked = []
    quiesced.peer.operator = {"enable": 1}
    for ticks in ("200", "2000"):
        quiesced.start("--ticks", ticks, env=environment)
        assert quiesced.wait() == 0
        asked.append(int(counts.read_text()))
    assert asked[0] == asked[1] > 0


def receive_until(manager: socket.socket, text: str) -> str:
    """Reads datagrams of sd_notify up to the one that holds the text."""
    while True:
        message = manager.recv(4096).decode()
        if text in message:
            return message


def test_service_manager_is_kept_informed(quiesced: Quiesced, tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.settimeout(PATIENCE_S)
        manager.bind(str(tmp_path / "notify"))
        environment = {"NOTIFY_SOCKET": str(tmp_path / "notify"), "WATCHDOG_USEC": "200000"}
        quiesced.start(env={**os.environ, **environment})
        receive_until(manager, "READY=1")
        receive_until(manager, "WATCHDOG=1")
        receive_until(manager, "STATUS=")
        quiesced.signal(signal.SIGHUP)
        assert "MONOTONIC_USEC=" in receive_until(manager, "RELOADING=1")
        receive_until(manager, "READY=1")
        quiesced.signal(signal.SIGTERM)
        receive_until(manager, "STOPPING=1")
        assert quiesced.wait() == 0
