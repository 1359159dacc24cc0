"""Tries mutants: compiles what a mutant touches, and runs the tests that have it in them."""

import hashlib
import os
import resource
import shutil
import subprocess
import threading
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue

from quiesce.base.errors import BenchFailure

from quiesce_benchmarks.trust.c_tests import Build, CTest
from quiesce_benchmarks.trust.mutate import Mutant

# CPU of a test, in times of what it takes without a mistake, and at least.
CPU_TIMES, CPU_LEAST_S = 10.0, 2.0
WALL_S = 600.0
SOURCES = "firmware"


@dataclass(frozen=True)
class Outcome:
    mutant: Mutant
    killed_by: str | None  # name of the test; None: it survived
    code: str  # digest of its machine code
    is_mutant: bool = True  # False: it does not compile, or its machine code is the right one


class Bed:
    """A folder of its own with a copy of the sources, in which one mutant at a time is tried."""

    def __init__(self, build: Build, root: Path, folder: Path) -> None:
        self.build, self.root, self.folder = build, root, folder
        self.objects: dict[str, Path | None] = {}  # of the mutant that is planted
        shutil.copytree(root / SOURCES, folder / SOURCES)

    @contextmanager
    def planted(self, mutant: Mutant) -> Iterator[None]:
        file = self.folder / mutant.path
        source = file.read_bytes()
        file.write_bytes(mutant.applied(source))
        self.objects.clear()
        try:
            yield
        finally:
            file.write_bytes(source)

    def object(self, made: str) -> Path | None:
        """Of the mutant that is planted; None where the compiler refuses it."""
        if made not in self.objects:
            self.objects[made] = self.compile(made)
        return self.objects[made]

    def compile(self, made: str) -> Path | None:
        here = [
            word.replace(f"{self.root}/{SOURCES}", f"{self.folder}/{SOURCES}")
            for word in self.build.compile[made]
        ]
        out = self.folder / hashlib.sha256(made.encode()).hexdigest()[:16]
        here[here.index("-o") + 1] = str(out)
        # Warnings about a mistake would keep it from being tried.
        done = subprocess.run([*here, "-w"], cwd=self.build.folder, capture_output=True)
        return out if done.returncode == 0 else None

    def runs(self, test: CTest, objects: dict[str, Path], cpu_s: float) -> bool:
        """Whether the test passes with these objects in it."""
        program = self.folder / "program"
        link = test.link_with(objects, program)
        done = subprocess.run(link, cwd=self.build.folder, capture_output=True)
        if done.returncode != 0:
            raise BenchFailure(f"{test.name} does not link with a mutant in it")
        command = test.command_for(program, self.build.folder)
        return is_passed(command, self.folder, cpu_s)


def digest_of(file: Path | None) -> str:
    return "" if file is None else hashlib.sha256(file.read_bytes()).hexdigest()


def is_passed(command: Sequence[str], folder: Path, cpu_s: float) -> bool:
    # Limited by CPU: a mutant that hangs ends, whatever else the machine does.
    limited = [
        "sh",
        "-c",
        f'ulimit -c 0; ulimit -t {max(1, round(cpu_s))}; exec "$@"',
        "sh",
        *command,
    ]
    process = subprocess.Popen(
        limited,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        return process.wait(timeout=WALL_S) == 0
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return False


class Trial:
    """Tries mutants on some beds at a time; learns which tests kill."""

    def __init__(self, build: Build, root: Path, folder: Path, jobs: int) -> None:
        self.build, self.root, self.jobs = build, root, jobs
        self.beds: SimpleQueue[Bed] = SimpleQueue()
        for number in range(jobs):
            self.beds.put(Bed(build, root, folder / f"bed{number}"))
        self.cpu_s = {test.name: self.without_a_mistake(test) for test in build.tests}
        self.kills: Counter[tuple[str, str]] = Counter()
        self.lock = threading.Lock()

    def without_a_mistake(self, test: CTest) -> float:
        """CPU that a test takes, all of it passed."""
        before_s = children_cpu_s()
        if not is_passed(test.command, self.build.folder, WALL_S):
            raise BenchFailure(f"{test.name} fails without any mutant")
        return children_cpu_s() - before_s

    def order(self, path: str) -> list[CTest]:
        """Likeliest killers of a file's mutants first, then those that are quick."""
        stem = f"test_{Path(path).stem}"
        return sorted(
            self.build.tests,
            key=lambda test: (
                -self.kills[path, test.name],
                test.name != stem,
                self.cpu_s[test.name],
            ),
        )

    def try_all(self, mutants: Sequence[Mutant]) -> Iterator[Outcome]:
        """In their order."""
        with ThreadPoolExecutor(self.jobs) as pool:
            yield from pool.map(self.try_one, mutants)

    def try_one(self, mutant: Mutant) -> Outcome:
        bed = self.beds.get()
        try:
            return self.on_bed(bed, mutant)
        finally:
            self.beds.put(bed)

    def on_bed(self, bed: Bed, mutant: Mutant) -> Outcome:
        with bed.planted(mutant):
            code = digest_of(bed.object(self.build.first_object_of(self.root / mutant.path)))
            killer = self.killer(bed, mutant) if code else None
        is_mutant = any(self.is_other(made, one) for made, one in bed.objects.items())
        return Outcome(mutant, killer, code, bool(code) and is_mutant)

    def killer(self, bed: Bed, mutant: Mutant) -> str | None:
        """The name of the first test that fails with the mutant in it."""
        for test in self.order(mutant.path):
            needed = self.build.objects_of(test, self.root / mutant.path)
            here = {made: one for made in needed if (one := bed.object(made)) is not None}
            is_touched = any(self.is_other(made, one) for made, one in here.items())
            cpu_s = max(CPU_LEAST_S, CPU_TIMES * self.cpu_s[test.name])
            if is_touched and not bed.runs(test, here, cpu_s):
                with self.lock:
                    self.kills[mutant.path, test.name] += 1
                return test.name
        return None

    def is_other(self, made: str, compiled: Path | None) -> bool:
        """Whether an object is not what the sources make."""
        return digest_of(compiled) != digest_of(self.build.folder / made)


def children_cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def default_jobs() -> int:
    return max(1, min(2, os.cpu_count() or 1))
