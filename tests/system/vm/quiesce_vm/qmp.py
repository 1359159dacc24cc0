"""QEMU's two control sockets: QMP (docs/interop/qmp-spec) and qtest (docs/devel/testing/qtest).

QMP names the machine's parts; qtest sets the level of a device's input line and tells each change
of its output lines.
"""

import json
import re
import socket
import threading
from typing import Any

from quiesce.base.errors import BenchFailure

from quiesce_vm.limits import HANG_S


class Qmp:
    """One command at a time; events are skipped."""

    def __init__(self, connection: socket.socket) -> None:
        self._socket = connection
        self._socket.settimeout(HANG_S)
        self._lines = connection.makefile("r", encoding="utf-8", errors="replace")
        self._read()  # the greeting
        self.execute("qmp_capabilities")

    def execute(self, command: str, **arguments: Any) -> Any:
        """What the command returns. BenchFailure where QEMU refuses it or is gone."""
        request = json.dumps({"execute": command, "arguments": arguments})
        _send(self._socket, request + "\n")
        while True:
            reply = self._read()
            if "return" in reply:
                return reply["return"]
            if "error" in reply:
                raise BenchFailure(f"QEMU refused {command}: {reply['error'].get('desc')}")

    def ending(self) -> str:
        """Why the machine stopped ("guest-shutdown", "guest-reset"); waits for it."""
        while True:
            event = self._read()
            if event.get("event") == "SHUTDOWN":
                return str(event["data"]["reason"])

    def device(self, kind: str) -> str:
        """Path of the machine's only device of that type ("pl061"); its number varies."""
        folder = "/machine/unattached"
        for item in self.execute("qom-list", path=folder):
            if item["type"] == f"child<{kind}>":
                return f"{folder}/{item['name']}"
        raise BenchFailure(f"QEMU's machine has no {kind}")

    def _read(self) -> dict[str, Any]:
        try:
            line = self._lines.readline()
        except OSError as error:
            raise BenchFailure(f"QEMU's control socket is silent: {error}")
        try:
            reply = json.loads(line)
        except ValueError:
            raise BenchFailure(f"QEMU's control socket said {line[:100]!r}, which is no answer")
        if not isinstance(reply, dict):
            raise BenchFailure(f"QEMU's control socket said {line[:100]!r}, which is no answer")
        return reply


class Qtest:
    """Input and output lines of one device."""

    def __init__(self, connection: socket.socket, device: str) -> None:
        self._device = device
        self._socket = connection
        self._lines = connection.makefile("r", encoding="utf-8", errors="replace")
        self._levels: dict[int, bool] = {}
        self._changed = threading.Lock()
        threading.Thread(target=self._read, daemon=True).start()
        _send(self._socket, f"irq_intercept_out {device}\n")

    def set_input(self, line: int, level: bool) -> None:
        """Sets an input line of the device from outside."""
        _send(self._socket, f"set_irq_in {self._device} unnamed-gpio-in {line} {int(level)}\n")

    def output(self, line: int) -> bool | None:
        """Level of an output line; None where it has never changed."""
        with self._changed:
            return self._levels.get(line)

    def _read(self) -> None:
        try:
            for text in self._lines:
                change = output_change(text)
                if change is not None:
                    with self._changed:
                        self._levels[change[0]] = change[1]
        except (OSError, ValueError):  # closed
            pass


def output_change(text: str) -> tuple[int, bool] | None:
    """Line and level of qtest's "IRQ raise 2"; None for anything else."""
    match = re.fullmatch(r"IRQ (raise|lower) (\d+)", text.strip())
    return (int(match[2]), match[1] == "raise") if match else None


def _send(connection: socket.socket, text: str) -> None:
    try:
        connection.sendall(text.encode())
    except OSError as error:
        raise BenchFailure(f"QEMU's control socket is gone: {error}")
