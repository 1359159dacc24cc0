"""The controller program on a machine that fails it: full disks, closed files, a lost adapter."""

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from quiesced_peer import Peer, Quiesced, on_a_pty, open_pty
from quiesced_steps import FAULT, RUN, hang_up, in_a_row, preload, start_running


@pytest.fixture
def quiesced(tmp_path: Path) -> Iterator[Quiesced]:
    with on_a_pty(tmp_path) as under_test:
        yield under_test


def test_full_disk_for_the_log(quiesced: Quiesced) -> None:
    quiesced.write_config(to='"/dev/full"')
    start_running(quiesced)
    peer = quiesced.peer
    peer.wait("Identification", after=peer.count())
    assert quiesced.stop() == 0
    log = quiesced.log_text()
    assert log.count("log file /dev/full: No space left on device") == 1
    assert len(log.splitlines()) == 1


def test_full_disk_for_the_state(quiesced: Quiesced) -> None:
    start_running(quiesced)
    peer = quiesced.peer
    # What a full disk does to each write, without a disk of our own.
    (quiesced.state / "state.json.new").mkdir()
    quiesced.signal(signal.SIGUSR1)
    quiesced.wait_log("status file: not written: ")
    after = peer.count()
    peer.wait("Status", lambda s: s["state"] == RUN, after)
    (quiesced.state / "state.json.new").rmdir()
    quiesced.signal(signal.SIGUSR1)
    quiesced.wait_log("status file: written again")
    assert quiesced.stop() == 0


def test_closed_standard_files(quiesced: Quiesced) -> None:
    quiesced.peer.operator = {"enable": 1}
    quiesced.process = subprocess.Popen(
        ["/bin/sh", "-c", 'exec "$0" --config "$1" <&- >&- 2>&-', quiesced.program, quiesced.config]
    )
    quiesced.peer.wait_state(RUN)
    assert quiesced.stop() == 0
    assert quiesced.status()["can"]["malformed"] == 0


def test_stderr_that_nobody_reads(quiesced: Quiesced) -> None:
    reader, writer = os.pipe()
    start = {"stderr": writer}
    quiesced.peer.operator = {"enable": 1}
    os.set_blocking(writer, False)
    filled = 0
    try:
        while True:
            filled += os.write(writer, b"x" * 4096)
    except BlockingIOError:
        os.set_blocking(writer, True)
    quiesced.start(**start)
    os.close(writer)
    quiesced.peer.wait_state(RUN)
    assert quiesced.stop() == 0
    os.close(reader)
    assert filled > 0


def test_lost_and_found_serial_line(quiesced: Quiesced, tmp_path: Path) -> None:
    """The adapter is unplugged and plugged in again."""
    link = tmp_path / "adapter"
    link.symlink_to(quiesced.peer.line)
    quiesced.write_config()
    quiesced.config.write_text(quiesced.config.read_text().replace(quiesced.peer.line, str(link)))
    start_running(quiesced)
    master, slave, line = open_pty()
    second = Peer(master, line, operator={"enable": 1}, acknowledges=True)
    link.unlink()
    link.symlink_to(line)
    hang_up(quiesced)
    second.wait_state(RUN)
    assert quiesced.stop() == 0
    log = quiesced.log_text()
    assert "CAN: " in log
    second.close(slave)


def test_bus_that_stays_down_is_a_failure_of_its_drivers(
    quiesced: Quiesced, tmp_path: Path
) -> None:
    link = tmp_path / "adapter"
    link.symlink_to(quiesced.peer.line)
    quiesced.config.write_text(quiesced.config.read_text().replace(quiesced.peer.line, str(link)))
    start_running(quiesced)
    link.unlink()
    hang_up(quiesced)
    while "fault DRIVER_FAILED is kept" not in quiesced.log_text():
        time.sleep(0.01)
    master, slave, line = open_pty()
    second = Peer(master, line, operator={"enable": 1})
    link.symlink_to(line)
    second.wait("CurrentDemand", in_a_row(100, FAULT))
    second.acknowledges = True
    second.wait_state(RUN)
    assert quiesced.stop() == 0
    second.close(slave)


OVERRUNS = r"""
#define _GNU_SOURCE
#include <linux/serial.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>
int ioctl(int fd, unsigned long what, ...) {
    static int looks;
    va_list rest;
    va_start(rest, what);
    void *answer = va_arg(rest, void *);
    va_end(rest);
    if (what != TIOCGICOUNT) return (int)syscall(SYS_ioctl, fd, what, answer);
    struct serial_icounter_struct counts;
    memset(&counts, 0, sizeof counts);
    counts.overrun = looks++ < 2 ? 100 : 107;
    memcpy(answer, &counts, sizeof counts);
    return 0;
}
"""


def test_overrun_of_the_serial_line_is_told(quiesced: Quiesced, tmp_path: Path) -> None:
    """The kernel counts what its UART has lost; those before the start are nobody's."""
    library = preload(tmp_path, "overruns", OVERRUNS)
    quiesced.start(env={**os.environ, "LD_PRELOAD": library})
    quiesced.wait_log("CAN: serial line: 7 bytes lost, nobody took them in time (overrun)")
    assert quiesced.stop() == 0
    assert quiesced.status()["can"]["overruns"] == 7


WITNESS = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>
static int line = -1;
static void note(const char *what) {
    char text[32];
    const char *thread = gettid() == getpid() ? "loop" : "other";
    const int length = snprintf(text, sizeof text, "%s %s\n", what, thread);
    const int out = openat(AT_FDCWD, getenv("WITNESS_FILE"), O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (write(out, text, (size_t)length) != length) abort();
    ((int (*)(int))dlsym(RTLD_NEXT, "close"))(out);
}
int open64(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const int fd = openat(AT_FDCWD, path, flags, va_arg(rest, int));
    va_end(rest);
    if (fd >= 0 && strcmp(path, getenv("WITNESS_LINE")) == 0) { line = fd; note("open"); }
    return fd;
}
int open(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const int mode = va_arg(rest, int);
    va_end(rest);
    return open64(path, flags, mode);
}
int close(int fd) {
    if (fd >= 0 && fd == line) { line = -1; note("close"); }
    return ((int (*)(int))dlsym(RTLD_NEXT, "close"))(fd);
}
int tcsetattr(int fd, int when, const struct termios *set) {
    note("set");
    int (*real)(int, int, const struct termios *) = dlsym(RTLD_NEXT, "tcsetattr");
    return real(fd, when, set);
}
"""


def test_the_loop_never_opens_or_closes_the_bus(quiesced: Quiesced, tmp_path: Path) -> None:
    """An adapter that is plugged in again is the other thread's, whatever its driver takes."""
    link, calls = tmp_path / "adapter", tmp_path / "calls"
    link.symlink_to(quiesced.peer.line)
    quiesced.config.write_text(quiesced.config.read_text().replace(quiesced.peer.line, str(link)))
    environment = {
        **os.environ,
        "LD_PRELOAD": preload(tmp_path, "witness", WITNESS),
        "WITNESS_LINE": str(link),
        "WITNESS_FILE": str(calls),
    }
    quiesced.peer.operator = {"enable": 1}
    quiesced.start(env=environment)
    quiesced.peer.wait_state(RUN)
    assert calls.read_text().split("\n") == ["open loop", "set loop", ""]  # before its first tick
    master, slave, line = open_pty()
    second = Peer(master, line, operator={"enable": 1}, acknowledges=True)
    link.unlink()
    link.symlink_to(line)
    hang_up(quiesced)
    second.wait_state(RUN)
    assert calls.read_text().split("\n")[2:] == ["close other", "open other", "set other", ""]
    assert quiesced.stop() == 0
    assert quiesced.status()["can"]["down"] == 1
    assert quiesced.status()["can"]["tx_dropped"] > 0
    os.close(slave)
    os.close(master)


def test_lost_ticks_and_missing_priority_are_told(quiesced: Quiesced) -> None:
    start_running(quiesced)
    quiesced.wait_log("no real-time priority (loop.priority is 0)")
    quiesced.signal(signal.SIGSTOP)
    time.sleep(0.1)  # fifty ticks
    quiesced.signal(signal.SIGCONT)
    quiesced.wait_log("other processes had the CPU, and the loop has no real-time priority")
    assert quiesced.stop() == 0
    loop = quiesced.status()["loop"]
    assert loop["has_real_time_priority"] is False
    assert sum(loop["lost"].values()) == loop["overruns"]
    assert loop["lost"]["no_priority"] > 0
