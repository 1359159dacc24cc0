"""`./tools/benchmark trust`: its mutants are what they should be, and are judged as they fare."""

import re
import subprocess
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce.base.errors import BenchFailure
from quiesce_benchmarks.trust import abuse, flips, mutants
from quiesce_benchmarks.trust.c_tests import Build, CTest, archive_of
from quiesce_benchmarks.trust.mutate import Mutant, enums, mutants_of, neighbours
from quiesce_benchmarks.trust.trial import Outcome, Trial, is_passed

SOURCE = b"""#include "x.h"
#define MOST 5u
#define RUN STATE_RUN
typedef enum { EVENT_STOP, EVENT_GO, EVENTS } event_t;
_Static_assert(MOST == 5u, "not code");
static const unsigned char next[2][EVENTS] = {{STATE_OFF, RUN}, {STATE_OFF, RUN}};
int step(int a, int b) {
    // 1 + 1
    if (a < b && !b) {
        a += 2;
        return a - 1;
    }
    return next[0][1] == RUN ? a : -b;
}
"""
STATES = enums([b"enum { STATE_OFF = 0, STATE_RUN = 1, STATE_SAFE = 2, STATE_COUNT };"])


def made() -> list[Mutant]:
    return mutants_of("x.c", SOURCE, STATES)


def changes(kind: str) -> list[str]:
    return [one.key.split(": ", 1)[1] for one in made() if one.kind == kind]


def test_a_count_at_the_end_is_no_value() -> None:
    assert STATES == [["STATE_OFF", "STATE_RUN", "STATE_SAFE"]]
    assert enums([SOURCE]) == [["EVENT_STOP", "EVENT_GO"]]


def test_relations_logic_and_arithmetic_are_mistaken_for_their_neighbours() -> None:
    relations = changes("relation")
    assert "if (a < b && !b) { => if (a <= b && !b) {" in relations
    assert "if (a < b && !b) { => if (a >= b && !b) {" in relations
    assert changes("logic") == ["if (a < b && !b) { => if (a < b || !b) {"]
    assert changes("arithmetic") == ["a += 2; => a -= 2;", "return a - 1; => return a + 1;"]
    assert "if (a < b && !b) { => if (a < b && b) {" in changes("negation")


def test_conditions_are_negated_and_statements_left_out() -> None:
    assert len(changes("condition")) == 2
    # The last return of a function has to stay.
    assert changes("deletion") == ["a += 2; => ;", "return a - 1; => ;"]


def test_numbers_have_two_neighbours_of_their_type() -> None:
    assert neighbours("5u") == ("6u", "4u")
    assert neighbours("0x10") == ("17", "15")
    assert neighbours("0") == ("1", "(-1)")
    assert neighbours("0.5") == neighbours("MOST") == ()
    assert "#define MOST 5u => #define MOST 6u" in changes("constant")


def test_each_entry_of_a_table_becomes_each_other_state() -> None:
    entries = [one for one in made() if one.kind == "entry"]
    assert Counter(one.new for one in entries) == {"STATE_OFF": 2, "STATE_RUN": 2, "STATE_SAFE": 4}
    assert {one.line for one in entries} == {6}


def test_what_is_no_code_is_left_alone() -> None:
    assert not {one.line for one in made()} & {1, 3, 4, 5, 8}


def test_each_mutant_has_a_key_that_moves_with_its_lines() -> None:
    moved = mutants_of("x.c", b"\n\n" + SOURCE, STATES)
    assert [one.key for one in moved] == [one.key for one in made()]
    assert len({one.key for one in moved}) == len(moved)
    assert len({one.applied(b"\n\n" + SOURCE) for one in moved}) == len(moved)


def test_the_pool_has_every_entry_of_the_supervisors_table() -> None:
    pool = mutants.pool(ROOT)
    entries = [one for one in pool if one.kind == "entry" and "supervisor.c" in one.path]
    states = enums([(ROOT / mutants.STATES).read_bytes()])
    count = next(len(one) for one in states if "QUIESCE_STATE_RUN" in one)
    table = (ROOT / "firmware/guard/supervisor.c").read_text()
    events = len(set(re.findall(r"\bEVENT_\w+", table)))
    assert events >= 7 and len(entries) == count * events * (count - 1)
    assert len({one.key for one in pool}) == len(pool) >= 300
    assert set(entries) <= set(mutants.entries(pool))


def test_a_seed_draws_from_all_that_are_not_of_the_table() -> None:
    pool = mutants.pool(ROOT)
    drawn = mutants.drawn(pool, 1)
    assert drawn == mutants.drawn(pool, 1) != mutants.drawn(pool, 2)
    assert Counter(drawn) == Counter(pool) - Counter(mutants.entries(pool))
    assert len(drawn) >= mutants.COUNT


def test_equivalents_are_of_code_that_is_there() -> None:
    assert all(mutants.equivalents(mutants.pool(ROOT)).values())


def test_equivalents_of_other_code_or_without_an_argument_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "equivalents.toml"
    file.write_text('[[equivalent]]\nmutant = "gone"\nwhy = "a reason"\n')
    with pytest.raises(BenchFailure, match="no such mutant any more: gone"):
        mutants.equivalents(made(), file)
    file.write_text(f"[[equivalent]]\nmutant = '{made()[0].key}'\nwhy = ' '\n")
    with pytest.raises(BenchFailure, match="no argument"):
        mutants.equivalents(made(), file)


def test_what_survives_is_counted() -> None:
    one, two, three, four = made()[:4]
    outcomes = [Outcome(one, "test_a", "1"), Outcome(two, None, "2"), Outcome(three, None, "3")]
    result = mutants.judged([*outcomes, Outcome(four, "test_b", "4")], {two.key: "why"})
    assert result.survivors == [three]
    assert result.killed_pct == pytest.approx(200 / 3)
    assert result.equivalent_pct == 25.0
    with pytest.raises(BenchFailure, match="not equivalent, test_a kills it"):
        mutants.judged(outcomes, {one.key: "why"})


def test_what_is_no_mutant_or_the_same_code_again_does_not_count() -> None:
    one, two, three, four = made()[:4]
    same = [Outcome(one, "test_a", "1"), Outcome(two, "test_a", "1"), Outcome(three, None, "3")]
    none = Outcome(four, None, "0", is_mutant=False)
    assert mutants.distinct([*same, none]) == [same[0], same[2]]


def test_objects_take_the_place_of_those_in_libraries() -> None:
    assert archive_of("a/CMakeFiles/core.dir/b/c.c.o") == "a/libcore.a"
    test = CTest("test_x", "t/test_x", ["/b/t/test_x", "-q"], "cc x.o -o t/test_x a/core.a".split())
    objects = {"x.o": Path("/n/x"), "a/CMakeFiles/core.dir/y.o": Path("/n/y")}
    assert test.link_with(objects, Path("/n/p")) == "cc /n/x -o /n/p /n/y a/core.a".split()
    assert test.command_for(Path("/n/p"), Path("/b")) == ["/n/p", "-q"]


@pytest.mark.slow
def test_a_test_that_hangs_fails(tmp_path: Path) -> None:
    assert is_passed(["true"], tmp_path, 1.0)
    assert not is_passed(["false"], tmp_path, 1.0)
    assert not is_passed(["sh", "-c", "while :; do :; done"], tmp_path, 1.0)


PROJECT = {
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.25)
project(small LANGUAGES C)
enable_testing()
add_subdirectory(firmware)
add_subdirectory(tests/unit/firmware)
""",
    "firmware/CMakeLists.txt": """add_library(core STATIC block.c)
target_include_directories(core PUBLIC .)
""",
    "firmware/block.h": "static inline int most(void) { return 7; }\nint add(int a, int b);\n",
    "firmware/block.c": '#include "block.h"\nint add(int a, int b) { return a + b; }\n',
    "tests/unit/firmware/CMakeLists.txt": """add_executable(test_block test_block.c)
target_link_libraries(test_block PRIVATE core)
add_test(NAME test_block COMMAND test_block)
""",
    "tests/unit/firmware/test_block.c": """#include "block.h"
int main(void) { return add(2, 2) == 4 && most() > 6 ? 0 : 1; }
""",
}


@pytest.fixture
def small(tmp_path: Path) -> Iterator[tuple[Path, Build]]:
    """A project with one block and its test, built."""
    root = tmp_path / "a project"
    for name, text in PROJECT.items():
        file = root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    build = root / "build/host"
    options = ["-G", "Ninja", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"]
    quiet = {"check": True, "stdout": subprocess.DEVNULL}
    subprocess.run(["cmake", "-S", root, "-B", build, *options], **quiet)
    subprocess.run(["ninja", "-C", build], **quiet)
    yield root, Build(build)


@pytest.mark.slow
def test_mutants_are_compiled_linked_and_judged(small: tuple[Path, Build], tmp_path: Path) -> None:
    root, build = small
    block = root / "firmware/block.c"
    header = root / "firmware/block.h"
    found = mutants_of("firmware/block.c", block.read_bytes(), [])
    found += mutants_of("firmware/block.h", header.read_bytes(), [])
    at = found[0].start
    broken = Mutant("firmware/block.c", 2, "constant", at, at + 1, "+ +(", "no C")
    same = Mutant("firmware/block.c", 2, "arithmetic", at, at + 1, "- -", "the same code")
    outcomes = list(Trial(build, root, tmp_path, 2).try_all([*found, broken, same]))
    fate = {one.mutant.key.split("=> ")[-1]: one.killed_by for one in outcomes}
    assert fate == {
        "int add(int a, int b) { return a - b; }": "test_block",
        "static inline int most(void) { return 8; }": None,
        "static inline int most(void) { return 6; }": "test_block",
        "no C": None,
        "the same code": None,
    }
    assert [one.is_mutant for one in outcomes] == [True, True, True, False, False]
    assert block.read_text() == PROJECT["firmware/block.c"]


def test_every_part_of_the_abuse_has_a_seed_and_all_ticks_are_had() -> None:
    for ticks in (1, abuse.QUICK_TICKS, abuse.TICKS):
        calls = abuse.calls(ticks, 7)
        assert {program for program, _ in calls} == {"abuse", "abuse_many"}
        assert len({words[0] for _, words in calls}) == len(calls)
        assert sum(words[1] for _, words in calls) >= ticks
    seeds = [words[0] for _, words in flips.calls(7, quick=False)]
    assert len(set(seeds)) == len(seeds)
