"""An FMU that runs, of either version, by fmpy: values by name, errors in one line."""

import shutil
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.extras import extra
from quiesce.base.nearest import listed
from quiesce.base.paths import shown

# Types of variables by what reads and writes them.
ACCESS = {
    "2.0": {"Real": "Real", "Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean"},
    "3.0": {
        **{name: name for name in ("Float64", "Float32", "Int8", "UInt8", "Int16", "UInt16")},
        **{name: name for name in ("Int32", "UInt32", "Int64", "UInt64", "Boolean")},
        "Enumeration": "Int64",
    },
}
BOOLEAN = "Boolean"


class Slave:
    """Started at time 0. Use it in a with statement."""

    def __init__(self, file: Path, start_values: dict[str, float], stop_s: float) -> None:
        """UsageError where the file is no such FMU, or refuses to start."""
        with extra("fmu", "an FMU that runs"):
            import fmpy
        self.name = file.stem
        self._messages: list[str] = []
        self._folder = ""
        self._fmu: Any = None
        try:
            with self._told(shown(file)):
                self._folder = fmpy.extract(str(file))
                self.description: Any = fmpy.read_model_description(self._folder)
            self._variables = {one.name: one for one in self.description.modelVariables}
            version = self.description.fmiVersion
            self.version = "3.0" if version.startswith("3") else "2.0"
            if self.description.coSimulation is None or version.startswith("1"):
                raise UsageError(
                    f"{shown(file)}: expected an FMU for co-simulation of FMI 2.0 or 3.0"
                )
            with self._told(shown(file)):
                self._fmu = self._instance()
                self._start(start_values, stop_s)
        except UsageError:
            self.close()
            raise

    def __enter__(self) -> "Slave":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        if self._fmu is not None:
            fmu, self._fmu = self._fmu, None
            fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)

    @contextmanager
    def _told(self, who: str = "") -> Iterator[None]:
        """What fmpy or the FMU says as one line."""
        try:
            yield
        except UsageError:
            raise
        except Exception as error:  # fmpy raises whatever its parts raise
            told = self._messages[-1] if self._messages else str(error)
            raise UsageError(f"{who or self.name}: {one_line(told)}") from None

    def _instance(self) -> Any:
        from fmpy import fmi2, fmi3

        words = {
            "guid": self.description.guid,
            "unzipDirectory": self._folder,
            "modelIdentifier": self.description.coSimulation.modelIdentifier,
            "instanceName": self.name,
        }
        if self.version == "3.0":
            fmu = fmi3.FMU3Slave(**words)
            fmu.instantiate(logMessage=lambda _e, _s, _c, text: self._message(text))
            return fmu
        fmu = fmi2.FMU2Slave(**words)
        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
            lambda _e, _n, _s, _c, text: self._message(text)
        )
        self._callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
        self._callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
        fmu.instantiate(callbacks=self._callbacks)
        return fmu

    def _message(self, text: bytes) -> None:
        self._messages.append(text.decode(errors="replace"))

    def _start(self, start_values: dict[str, float], stop_s: float) -> None:
        if self.version == "2.0":
            self._fmu.setupExperiment(startTime=0.0, stopTime=stop_s)
            self._set_all(start_values)
            self._fmu.enterInitializationMode()
        else:
            self._set_all(start_values)
            self._fmu.enterInitializationMode(startTime=0.0, stopTime=stop_s)
        self._fmu.exitInitializationMode()

    def _set_all(self, values: dict[str, float]) -> None:
        for name, value in values.items():
            self.writer([name])([value])

    def names(self, causality: str) -> list[str]:
        return [name for name, one in self._variables.items() if one.causality == causality]

    def variable(self, name: str) -> Any:
        """fmpy's description of it. UsageError where there is none."""
        if name not in self._variables:
            known = [*self.names("input"), *self.names("output"), *self.names("parameter")]
            raise UsageError(f"{self.name} has no variable {name}; {listed(name, known)}")
        return self._variables[name]

    def _access(self, name: str) -> str:
        kind = self.variable(name).type
        if kind not in ACCESS[self.version]:
            raise UsageError(f"{self.name}: {name} is of type {kind}, which no value here has")
        return ACCESS[self.version][kind]

    def _groups(self, names: Sequence[str]) -> list[tuple[str, list[int], list[int]]]:
        """Of each type: its name, places among names, value references."""
        groups: dict[str, tuple[list[int], list[int]]] = {}
        for place, name in enumerate(names):
            places, references = groups.setdefault(self._access(name), ([], []))
            places.append(place)
            references.append(self.variable(name).valueReference)
        return [(access, *both) for access, both in groups.items()]

    def reader(self, names: Sequence[str]) -> "Reader":
        return Reader(self, names)

    def writer(self, names: Sequence[str]) -> "Writer":
        return Writer(self, names)

    def step(self, from_s: float, length_s: float) -> None:
        with self._told():
            self._fmu.doStep(from_s, length_s)

    def save(self) -> bytes:
        """Its state, serialised."""
        with self._told():
            getter = "getFMUState" if self.version == "3.0" else "getFMUstate"
            state = getattr(self._fmu, getter)()
            suffix = "FMUState" if self.version == "3.0" else "FMUstate"
            text = getattr(self._fmu, f"serialize{suffix}")(state)
            getattr(self._fmu, f"free{suffix}")(state)
            return bytes(text)

    def load(self, saved: bytes) -> None:
        with self._told():
            suffix = "FMUState" if self.version == "3.0" else "FMUstate"
            verb = "deserialize" if self.version == "3.0" else "deSerialize"
            state = getattr(self._fmu, f"{verb}{suffix}")(saved)
            getattr(self._fmu, f"set{suffix}")(state)
            getattr(self._fmu, f"free{suffix}")(state)


class Reader:
    """Values of variables, in the order of their names."""

    def __init__(self, slave: Slave, names: Sequence[str]) -> None:
        self._slave = slave
        self._count = len(names)
        self._groups = [
            (getattr(slave._fmu, f"get{access}"), places, references)
            for access, places, references in slave._groups(names)
        ]

    def __call__(self) -> list[float]:
        out = [0.0] * self._count
        with self._slave._told():
            for get, places, references in self._groups:
                for place, value in zip(places, get(references), strict=True):
                    out[place] = value
        return out


class Writer:
    """Likewise, to set them."""

    def __init__(self, slave: Slave, names: Sequence[str]) -> None:
        self._slave = slave
        self._groups = [
            (getattr(slave._fmu, f"set{access}"), access, places, references)
            for access, places, references in slave._groups(names)
        ]

    def __call__(self, values: Iterable[float]) -> None:
        given = list(values)
        with self._slave._told():
            for write, access, places, references in self._groups:
                typed = [cast(access, given[place]) for place in places]
                write(references, typed)


def cast(access: str, value: float) -> float | int | bool:
    if access == BOOLEAN:
        return bool(value)
    return float(value) if access in ("Real", "Float64", "Float32") else int(value)
