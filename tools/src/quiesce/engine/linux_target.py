"""The target `linux` of `quiesce hil`: the CAN channel that leads to `quiesced --lockstep`.

The user names one with --can; without it, the program of this build is started here, on a pair of
ptys that stand for the bus.
"""

import os
import select
import selectors
import subprocess
import tempfile
import threading
import tty
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.paths import build_folder
from quiesce.engine.bench import ending, require_file

END_TIME_s = 10.0
BLOCK = 4096
MOST_SAID = 500


class PtyBus:
    """Two ptys joined back to back: what one side writes the other reads, byte for byte.

    `paths` are what two programs open as their serial lines; either may close and open its own
    again. Ends with close(), or as a context.
    """

    def __init__(self) -> None:
        pairs = [os.openpty(), os.openpty()]
        self._masters = [master for master, _ in pairs]
        # Held open, so that a side that nobody has open is no hang-up.
        self._slaves = [slave for _, slave in pairs]
        for slave in self._slaves:
            tty.setraw(slave)
        for master in self._masters:
            os.set_blocking(master, False)
        self.paths = [os.ttyname(slave) for slave in self._slaves]
        self._wake_read, self._wake_write = os.pipe()
        self._thread = threading.Thread(target=self._pump, daemon=True)
        self._thread.start()

    def _pump(self) -> None:
        other = dict(zip(self._masters, reversed(self._masters), strict=True))
        with selectors.DefaultSelector() as ready:
            for number in (*self._masters, self._wake_read):
                ready.register(number, selectors.EVENT_READ)
            while True:
                for key, _ in ready.select():
                    if key.fd == self._wake_read:
                        return
                    self._pass_on(os.read(key.fd, BLOCK), other[key.fd])

    def _pass_on(self, data: bytes, number: int) -> None:
        """Waits where the other side does not read, but not beyond close()."""
        while data:
            try:
                data = data[os.write(number, data) :]
            except BlockingIOError:
                if select.select([self._wake_read], [number], [])[0]:
                    return

    def close(self) -> None:
        os.close(self._wake_write)
        self._thread.join()
        for number in (*self._masters, *self._slaves, self._wake_read):
            os.close(number)

    def __enter__(self) -> "PtyBus":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def configuration(line: str) -> str:
    """What --lockstep needs of quiesced.toml, and sections that it does not look at."""
    return (
        f'[can]\ninterface = "slcan:{line}"\n\n[accel]\nsource = "can"\n\n'
        '[current]\noutput = "can"\n'
    )


def quiesced() -> Path:
    return require_file(
        build_folder() / "host/targets/linux/quiesced/quiesced", "the Linux controller"
    )


@contextmanager
def local_quiesced(program: Path) -> Iterator[str]:
    """Runs `quiesced --lockstep` on this machine and yields the channel that leads to it.

    BenchFailure, in the place of what the block raised, where the program ended before the block.
    """
    with PtyBus() as bus, tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        config, log = Path(folder) / "quiesced.toml", Path(folder) / "log"
        config.write_text(configuration(bus.paths[0]), encoding="utf-8")
        command = [str(program), "--config", str(config), "--lockstep"]
        with running(command, log) as process:
            try:
                yield f"slcan:{bus.paths[1]}"
            except UsageError as error:
                if process.poll() is not None:
                    raise BenchFailure(end_of("quiesced --lockstep", process, log)) from error
                raise


@contextmanager
def running(command: Sequence[str], log: Path) -> "Iterator[subprocess.Popen[bytes]]":
    """The program, ended with the block. log: what it says; Ctrl-C is for who started it."""
    with log.open("ab") as said:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=said, stderr=said, start_new_session=True
        )
    try:
        yield process
    finally:
        end(process)


def end_of(name: str, process: "subprocess.Popen[bytes]", log: Path) -> str:
    """A line about one that has ended."""
    said = one_line(log.read_text(errors="replace")[-MOST_SAID:]) or "it said nothing"
    return f"{name} ended with {ending(process.returncode)}: {said}"


def end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(END_TIME_s)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


@contextmanager
def linux_channel(channel: str | None) -> Iterator[str]:
    """What --can said; where it said nothing, the channel to a program of our own."""
    if channel is not None:
        yield channel
        return
    with local_quiesced(quiesced()) as own:
        yield own
