"""Transfers that go wrong at every block of ISO-TP, and power that goes at any time: the table in
use and the one that is stored are whole, and the old or the new one."""

import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.table import format_table
from quiesce.can.database import shipped

from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.seeds import generator
from quiesce_benchmarks.tables import largest
from quiesce_benchmarks.tables.client import client_of
from quiesce_benchmarks.tables.foreign import (
    CRC,
    DONE,
    LAW,
    STORED_CRC,
    ForeignClient,
    Silence,
    file_of,
    frames_of,
)
from quiesce_benchmarks.tables.targets import TARGETS, HostNode, Mps2Node, Quiesced, Target, running

TITLE = "cuts: transfers that go wrong at every block, power that goes at any time"
FIGURES = (
    ("table_cuts", "trials", None, "higher"),
    ("table_lost", "trials", 0.0, "lower"),
)
FAULTS = ("cut", "damaged", "repeated", "reordered", "two senders")
BLOCK = 32  # frames
# Words of the tables: of a file that needs the long first frame on this machine's node, of a small
# one on targets that cost more time.
LARGE, SMALL = 1100, 400
QUICK_EVERY = 9  # blocks
MOMENTS, QUICK_MOMENTS = 24, 4  # of power cuts in a commit, and in a save
LATER = 1.3  # than such a step has taken, in parts of that time
SILENCE_S = 0.5  # of a transfer that has been given up


class PowerCut(Exception):
    """The target has been killed."""


@dataclass
class Tally:
    """trials and lost by target and what happened; notes of what was lost."""

    trials: dict[tuple[str, str], int] = field(default_factory=dict)
    lost: dict[tuple[str, str], int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def add(self, target: str, what: str, note: str) -> None:
        """note: empty where nothing was lost."""
        key = (target, what)
        self.trials[key] = self.trials.get(key, 0) + 1
        self.lost[key] = self.lost.get(key, 0) + bool(note)
        if note:
            self.notes.append(f"{target}, {what}: {note}")


@dataclass
class Scene:
    target: Target
    host: ForeignClient
    tables: Sequence[list[int]]  # alike, and each another one
    random: np.random.Generator
    old: list[int] = field(default_factory=list)  # in use
    turn: int = 0

    def next(self) -> list[int]:
        """Another one than is in use."""
        while (found := self.tables[self.turn % len(self.tables)]) == self.old:
            self.turn += 1
        self.turn += 1
        return found


def alike(words: int) -> list[list[int]]:
    """Rules of one size."""
    return [largest.rules(words, seed) for seed in range(4)]


# ---- transfers that go wrong ----------------------------------------------------------------


def mangler(
    fault: str, at: int, other: list[bytes], random: np.random.Generator
) -> Callable[[int, bytes], Sequence[bytes]]:
    """What goes out in the place of frame `number`; the fault begins at frame `at`."""
    held: list[bytes] = []

    def mangle(number: int, frame: bytes) -> Sequence[bytes]:
        if fault == "two senders" and number >= at:
            return (frame, other[number - at])
        if fault == "cut" and number >= at:
            return ()
        if fault == "reordered" and number == at + 1:
            return (frame, held.pop())
        if number != at:
            return (frame,)
        if fault == "reordered":
            held.append(frame)
            return ()
        if fault == "repeated":
            return (frame, frame)
        byte, bit = int(random.integers(8)), int(random.integers(8))
        return (frame[:byte] + bytes([frame[byte] ^ 1 << bit]) + frame[byte + 1 :],)

    return mangle


def go_wrong(scene: Scene, fault: str, at: int) -> str:
    """One transfer; what was lost, empty: nothing."""
    new, other = scene.next(), scene.next()
    mangle = mangler(fault, at, frames_of(file_of(other)), scene.random)
    scene.host.send(file_of(new), mangle, SILENCE_S)
    expected, repeats = scene.old, scene.host.repeats
    for words in (new, other):
        if scene.host.ask("TABLE_COMMIT", LAW, words[1])[0] == DONE:
            expected = words
    # Asked twice, the second answer is that there is nothing: the first one is not known.
    allowed = [expected] if scene.host.repeats == repeats else [scene.old, new, other]
    note = judge(scene, allowed, [0])
    in_use = scene.host.info(LAW, CRC)
    scene.old = next((words for words in allowed if words[1] == in_use), scene.old)
    return note


def judge(scene: Scene, allowed: Sequence[list[int]], stored: Sequence[int]) -> str:
    """What is in use, all of its words; the CRC of what is stored."""
    found = scene.host.fetch(LAW)
    crc = scene.host.info(LAW, STORED_CRC)
    if found not in allowed:
        return f"{found[1] if found else 0:08x} is in use"
    if scene.host.info(LAW, CRC) != found[1]:
        return "it tells of another table than it sends"
    return "" if crc in stored else f"{crc:08x} is stored"


def frames_at(frames: int, every: int) -> Iterator[int]:
    """A frame in each block, its first one in the first."""
    for number, first in enumerate(range(1, frames, BLOCK)):
        if number % every == 0:
            yield min(first + 7 * number % BLOCK, frames - 2)


def line_faults(scene: Scene, tally: Tally, every: int) -> None:
    scene.old = scene.tables[0]
    require_done(scene.host.load(scene.old))
    frames = len(frames_of(file_of(scene.old)))
    for at in frames_at(frames, every):
        for fault in FAULTS:
            tally.add(scene.target.name, fault, go_wrong(scene, fault, at))


def require_done(result: str) -> None:
    if result != DONE:
        raise BenchFailure(f"a good table is answered with {result}")


# ---- power cuts -----------------------------------------------------------------------------


def keep_old(scene: Scene) -> None:
    require_done(scene.host.load(scene.old))
    require_done(scene.host.ask("TABLE_SAVE", LAW)[0])


def cut_in_transfer(scene: Scene, at: int) -> str:
    def mangle(number: int, frame: bytes) -> Sequence[bytes]:
        if number >= at:
            scene.target.kill()
            raise PowerCut
        return (frame,)

    try:
        scene.host.send(file_of(scene.next()), mangle)
    except PowerCut:
        pass
    return after_cut(scene, [scene.old])


def cut_after(scene: Scene, delay_s: float) -> None:
    time.sleep(delay_s)
    scene.target.kill()


def after_cut(scene: Scene, allowed: Sequence[list[int]]) -> str:
    """What the next start finds is in use, and what is stored is that."""
    scene.target.restart()
    note = judge(scene, allowed, [words[1] for words in allowed])
    in_use = scene.host.info(LAW, CRC)
    if not note and scene.host.info(LAW, STORED_CRC) != in_use:
        note = "another table is stored than is in use after the start"
    scene.old = next((words for words in allowed if words[1] == in_use), scene.old)
    return note


def cut_in_commit(scene: Scene, delay_s: float) -> str:
    new = scene.next()
    scene.host.send(file_of(new))
    scene.host.request("TABLE_COMMIT", LAW, new[1])
    cut_after(scene, delay_s)
    return after_cut(scene, [scene.old])


def cut_in_save(scene: Scene, delay_s: float) -> str:
    new = scene.next()
    require_done(scene.host.load(new))
    scene.host.request("TABLE_SAVE", LAW)
    cut_after(scene, delay_s)
    return after_cut(scene, [scene.old, new])


def taken_s(scene: Scene) -> tuple[float, float]:
    """By a commit and a save that nobody cuts."""
    new = scene.next()
    scene.host.send(file_of(new))
    begin_s = time.monotonic()
    require_done(scene.host.ask("TABLE_COMMIT", LAW, new[1])[0])
    middle_s = time.monotonic()
    require_done(scene.host.ask("TABLE_SAVE", LAW)[0])
    scene.old = new
    return middle_s - begin_s, time.monotonic() - middle_s


def power_cuts(scene: Scene, tally: Tally, moments: int, every: int) -> None:
    name = scene.target.name
    scene.old = scene.tables[0]
    keep_old(scene)
    commit_s, save_s = taken_s(scene)
    frames = len(frames_of(file_of(scene.old)))
    for at in frames_at(frames, every):
        tally.add(name, "power, transfer", cut_in_transfer(scene, at))
    for part in np.linspace(0.0, LATER, moments):
        tally.add(name, "power, commit", cut_in_commit(scene, part * commit_s))
        tally.add(name, "power, save", cut_in_save(scene, part * save_s))


# ---- all of it ------------------------------------------------------------------------------


def on_target(kind: type[Target], words: int, effort: Effort, work: Callable[[Scene], None]) -> str:
    """Why it ended before its end; empty: it did not."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            with running(kind, Path(folder) / "target") as target:
                with client_of(target.line) as client:
                    client.set({"law": "fuzzy"})
                host = ForeignClient(shipped(), target.line)
                target.line.forwards = frozenset()
                work(Scene(target, host, alike(words), generator(effort.seed, kind.name)))
        except (BenchFailure, UsageError, Silence) as error:
            return f"{kind.name}: {one_line(str(error))}"
    return ""


def measure(effort: Effort) -> Measured:
    tally = Tally()
    every = QUICK_EVERY if effort.is_quick else 1
    moments = QUICK_MOMENTS if effort.is_quick else MOMENTS
    ends = []
    for kind, words in ((HostNode, LARGE), (Mps2Node, SMALL), (Quiesced, SMALL)):
        ends.append(on_target(kind, words, effort, lambda scene: line_faults(scene, tally, every)))
    for kind in TARGETS:
        ends.append(
            on_target(kind, SMALL, effort, lambda scene: power_cuts(scene, tally, moments, every))
        )
    failed = [end for end in ends if end]
    lost = None if failed else float(sum(tally.lost.values()))
    values: dict[str, Any] = {"table_cuts": float(sum(tally.trials.values())), "table_lost": lost}
    rows = [
        {"target": target, "what": what, "trials": trials, "lost": tally.lost[target, what]}
        for (target, what), trials in tally.trials.items()
    ]
    reported = {"rows": rows, "notes": tally.notes, "ended": failed}
    return Measured(values, reported, (table_of(rows), *tally.notes, *failed))


def table_of(rows: Sequence[dict[str, Any]]) -> str:
    cells = [[row["target"], row["what"], str(row["trials"]), str(row["lost"])] for row in rows]
    return format_table(["target", "what goes wrong", "trials", "lost"], cells, (0, 1))
