"""A current driver on PWM whose writes begin to fail: the controller must not go on as if it drove.

The kernel's PWM files are a folder, and a library in front of libc's calls leads the program there
and makes writes fail on demand: this machine has no PWM.
"""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from quiesced_peer import Quiesced, on_a_pty
from quiesced_steps import FAULT, IDLE, RUN, preload

DRIVER_FAILED = 12

SHIM = r"""
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>
static const char *lead(const char *path, char place[512]) {
    static const char real[] = "/sys/class/pwm";
    if (strncmp(path, real, sizeof real - 1) != 0) return path;
    snprintf(place, 512, "%s/pwm%s", getenv("PWM_FOLDER"), path + sizeof real - 1);
    return place;
}
int open64(const char *path, int flags, ...) {
    char place[512];
    va_list rest;
    va_start(rest, flags);
    const int mode = va_arg(rest, int);
    va_end(rest);
    return (int)syscall(SYS_openat, AT_FDCWD, lead(path, place), flags, mode);
}
int open(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const int mode = va_arg(rest, int);
    va_end(rest);
    return open64(path, flags, mode);
}
int access(const char *path, int mode) {
    char place[512];
    return (int)syscall(SYS_faccessat, AT_FDCWD, lead(path, place), mode);
}
static int fails(int fd) {
    char link[64], path[512], mark[512];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    if (length < 0) return 0;
    path[length] = 0;
    snprintf(mark, sizeof mark, "%s/broken", getenv("PWM_FOLDER"));
    return strstr(path, "/pwm0/") != NULL && syscall(SYS_faccessat, AT_FDCWD, mark, F_OK) == 0;
}
ssize_t pwrite64(int fd, const void *data, size_t size, off_t place) {
    if (!fails(fd)) return syscall(SYS_pwrite64, fd, data, size, place);
    errno = EIO;
    return -1;
}
ssize_t pwrite(int fd, const void *data, size_t size, off_t place) {
    return pwrite64(fd, data, size, place);
}
ssize_t write(int fd, const void *data, size_t size) {
    if (!fails(fd)) return syscall(SYS_write, fd, data, size);
    errno = EIO;
    return -1;
}
"""

PWM = '"pwm"\nchip = "pwmchip0"\nperiod_ns = 50000\nfull_scale_mA = 5000'


@pytest.fixture
def quiesced(tmp_path: Path) -> Iterator[Quiesced]:
    law = 'law = "constant"\nconstant_current_mA = 4000\n'
    with on_a_pty(tmp_path, output=PWM, parameters=law) as under_test:
        yield under_test


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    channel = tmp_path / "pwm/pwmchip0/pwm0"
    channel.mkdir(parents=True)
    for name, text in (("../npwm", "1"), ("period", "0"), ("duty_cycle", "0"), ("enable", "0")):
        (channel / name).write_text(f"{text}\n")
    library = preload(tmp_path, "shim", SHIM)
    return {**os.environ, "LD_PRELOAD": library, "PWM_FOLDER": str(tmp_path)}


def first_number(file: Path) -> int:
    """A plain file keeps the tail of a longer number, a kernel's does not."""
    return int(file.read_text().splitlines()[0])


def test_driver_that_takes_no_command_is_a_latched_fault(quiesced, environment, tmp_path) -> None:
    peer, channel = quiesced.peer, tmp_path / "pwm/pwmchip0/pwm0"
    peer.operator = {"enable": 1}
    quiesced.start(env=environment)
    peer.wait("CurrentDemand", lambda s: s["state"] == RUN and s["current_cmd_mA"] == 4000)
    assert (first_number(channel / "duty_cycle"), first_number(channel / "enable")) == (40000, 1)

    after = peer.count()
    (tmp_path / "broken").touch()
    # A steady command is written again, too, and fails.
    failed = peer.wait("CurrentDemand", lambda s: s["state"] == FAULT, after)
    assert failed.signals["driver_is_enabled"] == 0
    assert failed.signals["current_cmd_mA"] == 0
    peer.wait("Status", lambda s: s["fault"] == DRIVER_FAILED, after)
    quiesced.wait_log("current output: it is opened anew")

    # Back it is off, and stays so until somebody acknowledges.
    (tmp_path / "broken").unlink()
    quiesced.wait_log("current output is back")
    peer.operator = {"enable": 1}
    after = peer.count()
    peer.wait("Identification", after=after)
    assert all(
        frame.signals["state"] == FAULT
        for frame in peer.frames[after:]
        if frame.name == "CurrentDemand"
    )
    assert first_number(channel / "enable") == 0
    peer.acknowledges = True
    peer.wait("CurrentDemand", lambda s: s["state"] == RUN and s["current_cmd_mA"] == 4000, after)
    assert quiesced.stop() == 0
    assert first_number(channel / "enable") == 0


def test_disturbed_output_is_a_latched_fault(quiesced, environment, tmp_path) -> None:
    """Something else switches the output to full current: it does not stay so."""
    peer, channel = quiesced.peer, tmp_path / "pwm/pwmchip0/pwm0"
    peer.operator = {"enable": 1}
    quiesced.start(env=environment)
    peer.wait("CurrentDemand", lambda s: s["state"] == RUN and s["current_cmd_mA"] == 4000)
    peer.operator = {"enable": 0}
    peer.wait("CurrentDemand", lambda s: s["state"] == IDLE, peer.count())
    after = peer.count()
    (channel / "duty_cycle").write_text("50000\n")
    (channel / "enable").write_text("1\n")
    peer.wait("CurrentDemand", lambda s: s["state"] == FAULT, after)
    peer.wait("Status", lambda s: s["fault"] == DRIVER_FAILED, after)
    quiesced.wait_log("writes failed or were not held")
    quiesced.wait_log("current output is back")
    assert (first_number(channel / "duty_cycle"), first_number(channel / "enable")) == (0, 0)
    assert quiesced.stop() == 0
