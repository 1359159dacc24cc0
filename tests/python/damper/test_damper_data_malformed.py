"""Bad recordings: each is refused in one line that names the row and says what to do."""

import random
import warnings
from pathlib import Path

import pytest
from damper_files import HEAD, ROWS, mapped, read, samples, text_of
from quiesce.base.errors import UsageError

GOOD = text_of(samples())
LINES = GOOD.splitlines()


def with_cell(line: int, column: int, cell: str) -> str:
    """The good text with one cell replaced; `line` as in the file, from 1."""
    lines = list(LINES)
    cells = lines[line - 1].split(",")
    cells[column] = cell
    lines[line - 1] = ",".join(cells)
    return "\n".join(lines) + "\n"


def without(first: int, end: int) -> str:
    return "\n".join(LINES[: first - 1] + LINES[end - 1 :]) + "\n"


def swapped() -> str:
    lines = list(LINES)
    lines[50], lines[51] = lines[51], lines[50]
    return "\n".join(lines) + "\n"


def three_in_a_row() -> str:
    rows = [(level, *row[:3]) for level in (0.0, 0.5, 1.0) for row in samples(100)]
    return text_of(rows, ("current_a", *HEAD[:3]))


def with_velocity(scale: float) -> str:
    rows = samples()
    speeds = [
        (rows[min(n + 1, ROWS - 1)][1] - rows[max(n - 1, 0)][1]) * 100.0 * scale
        for n in range(ROWS)
    ]
    return text_of([(*row, v) for row, v in zip(rows, speeds, strict=True)], (*HEAD, "v_mm_s"))


def uneven(n: int) -> float:
    return n / 200.0 + 0.0018 * (n % 7 - 3) / 3.0


# name: content, line that is named (None: of the file as a whole), what the message has to say
CASES: dict[str, tuple[str | bytes, int | None, str]] = {
    "empty": ("", 1, "empty; export it as CSV"),
    "blank": ("\n \n", 1, "empty; export it as CSV"),
    "comments only": ("# nothing\n# here\n", 1, "no header line"),
    "PNG": (b"\x89PNG\r\n\x1a\n" + bytes(200), 1, "a PNG image"),
    "JPEG": (b"\xff\xd8\xff\xe0" + bytes(200), 1, "a JPEG image"),
    "spreadsheet": (b"PK\x03\x04" + bytes(200), 1, "a spreadsheet or ZIP archive"),
    "MATLAB file": (b"MATLAB 5.0 MAT-file" + bytes(200), 1, "a MATLAB file"),
    "UTF-16": (GOOD.encode("utf-16"), 1, "UTF-16"),
    "Latin-1": ("t_s,x_mm,force_n,temp_°C\n".encode("latin-1"), 1, "not text in UTF-8"),
    "binary later on": (GOOD.encode() + b"\0\0\0", 402, "binary"),
    "JSON": ('{"t": [1, 2, 3]}', 1, "JSON or markup"),
    "HTML": ("<html><body>t,x,f</body></html>", 1, "JSON or markup"),
    "no header": ("\n".join(LINES[1:]), 1, "no header line"),
    "one column": ("force_n\n1\n2\n3\n", 1, "one column only"),
    "prose": ("Dear reader\nthis is a letter\n", 1, "one column only"),
    "units below the header": (
        text_of([("s", "mm", "N", "A"), *samples()], ("t", "x", "f", "i")), 1, "--time 't:UNIT'",
    ),
    "line of units": (text_of([("s", "mm", "N", "A"), *samples()]), 2, "a line of units"),
    "three rows": (text_of(samples(3)), 2, "3 rows of data"),
    "no rows": (text_of([]), 1, "0 rows of data"),
    "text cell": (with_cell(30, 2, "abc"), 30, "'abc' is not a number; repair"),
    "empty cell": (with_cell(31, 1, ""), 31, "an empty cell; fill it"),
    "NaN": (with_cell(32, 2, "NaN"), 32, "'NaN'; cut these rows"),
    "infinite": (with_cell(33, 2, "-inf"), 33, "'-inf'; cut these rows"),
    "overflow": (with_cell(33, 2, "1e400"), 33, "no measured value"),
    "underscore in a number": (with_cell(34, 2, "1_000"), 34, "'1_000' is not a number"),
    "short line": (with_cell(35, 3, "0.5").rsplit(",", 9)[0], None, "is the file cut short?"),
    "decimal commas between commas": (
        text_of([[f"{v:.3f}".replace(".", ",") for v in row] for row in samples()]), 2,
        "decimal commas need semicolons",
    ),
    "commas and points": (
        text_of(samples(), separator=";").replace("0.500000\n", "0,500000\n", 1), 2,
        "mixes decimal commas",
    ),
    "duplicate header": (
        text_of([(*row, 1.0) for row in samples()], (*HEAD, "force_n")), 1,
        "more than one column is named 'force_n'",
    ),
    "two forces": (
        text_of([(*row, 1.0) for row in samples()], (*HEAD, "load_n")), 1,
        "more than one column could be the force: force_n, load_n; name it with --force",
    ),
    "no force": (text_of(samples(), ("t_s", "x_mm", "y", "current_a")), 1, "--force NAME:UNIT"),
    "no motion": (text_of(samples(), ("t_s", "y", "f_n", "i_a")), 1, "--displacement NAME:UNIT"),
    "no time": (text_of(samples(), ("n", "x_mm", "f_n", "i_a")), 1, "--rate-hz"),
    "no unit": (text_of(samples(), ("t_s", "x_mm", "force", "i_a")), 1, "--force 'force:UNIT'"),
    "unknown unit": (
        text_of(samples(), ("t_s", "x_mm", "force_dyn", "i_a")), 1, "--force NAME:UNIT",
    ),
    "gap": (without(100, 110), 100, "10 samples missing; --split-gaps"),
    "one sample missing": (without(390, 391), 390, "1 samples missing; --split-gaps"),
    "repeated time": (with_cell(60, 0, "0.285000"), 60, "repeats that of the row before"),
    "rounded time": (
        mapped(lambda n, row: (round(row[0], 2), *row[1:])), None, "--time none --rate-hz",
    ),
    "unsorted time": (swapped(), 52, "sort the rows by time"),
    "several tests": (three_in_a_row(), 102, "3 tests one after the other; --group current_a"),
    "irregular": (
        mapped(lambda n, row: (uneven(n), *row[1:])), None, "irregular: time advances",
    ),
    "milliseconds as seconds": (
        mapped(lambda n, row: (1e3 * row[0], *row[1:])), 2, "is the unit of time right?",
    ),
    "constant time": (mapped(lambda n, row: (1.0, *row[1:])), 3, "repeats"),
    "constant displacement": (
        mapped(lambda n, row: (row[0], 2.5, *row[2:])), 2, "'x_mm' (displacement) is constant",
    ),
    "constant force": (
        mapped(lambda n, row: (*row[:2], 7.0, row[3])), 2, "'force_n' (force) is constant",
    ),
    "metres as millimetres": (
        mapped(lambda n, row: (row[0], 1e-3 * row[1], *row[2:])), 2, "implausibly small",
    ),
    "micrometres as millimetres": (
        mapped(lambda n, row: (row[0], 1e3 * row[1], *row[2:])), 2, "implausibly large",
    ),
    "kilonewtons as newtons": (
        mapped(lambda n, row: (*row[:2], 1e-3 * row[2], row[3])), 2, "the unit of force right?",
    ),
    "milliamperes as amperes": (
        mapped(lambda n, row: (*row[:3], 500.0)), 2, "the unit of current right?",
    ),
    "opposite force": (
        mapped(lambda n, row: (*row[:2], -row[2], row[3])), 2, "opposite sign: --flip-force",
    ),
    "velocity in another unit": (with_velocity(1e-3), 2, "wrong by a power of ten"),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_bad_recording_is_refused_with_row_and_hint(tmp_path: Path, name: str) -> None:
    content, line, hint = CASES[name]
    file = tmp_path / "bad.csv"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(UsageError) as caught:
        read(file)
    message = str(caught.value)
    assert hint in message
    assert "\n" not in message
    assert message.startswith(f"{file}:{line}" if line else f"{file}:")


def test_cases_differ_from_a_good_recording(tmp_path: Path) -> None:
    (tmp_path / "good.csv").write_text(GOOD)
    conditioned = read(tmp_path / "good.csv")
    assert len(conditioned.records) == 1 and len(conditioned.records[0]) == ROWS


def test_missing_file_and_folder_are_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none.csv", tmp_path):
        with pytest.raises(UsageError, match="name a CSV file"):
            read(path)


OPTIONS: dict[str, tuple[tuple[str, ...], str]] = {
    "no such column": (("--force", "load:N"), "no column is named 'load'; there are: t_s"),
    "no such unit": (("--force", "force_n:stone"), "use one of N, kN, kgf, lbf"),
    "factor": (("--force", "force_n:x*N"), "'x' is not a factor"),
    "factor of zero": (("--force", "force_n:0*N"), "'0' is not a factor"),
    "time twice": (("--time", "t_s", "--rate-hz", "200"), "exclude each other"),
    "no time at all": (("--time", "none"), "needs --rate-hz"),
    "two commands": (("--current", "current_a", "--current-a", "1"), "exclude each other"),
    "currents": (("--current-a", "0,1"), "2 values for 1 files"),
    "flipped": (("--flip-force",), "leave out --flip-force"),
    "group changes": (("--group", "t_s"), "name columns that are constant"),
    "no such group": (("--group", "test"), "no column is named 'test'"),
    "low-pass above Nyquist": (("--low-pass-hz", "100"), "at most 96"),
    "low-pass of nothing": (("--low-pass-hz", "1e-9"), "leaves no motion"),
    "work rate above": (("--work-rate-hz", "1000"), "above the 200 Hz"),
    "work rate too low": (("--work-rate-hz", "50"), "at least 100"),
    "no velocity": (("--use-velocity",), "name its column with --velocity"),
    "average": (("--output-average", "x"), "write seconds"),
    "average column": (("--output-average", "0.1:x_mm"), "does not end in _Hz"),
    "train alone": (("--train", "part=0,0.5"), "go together"),
    "unknown form": (("--train", "half=0,1", "--test", "part=0,1"), "write one of time_s"),
    "bad range": (("--train", "part=0.5,0.5", "--test", "part=0,1"), "has to be a range"),
    "no number": (("--train", "part=a,b", "--test", "part=0,1"), "such as part=0,0.5"),
    "beyond one": (("--train", "part=0,1.5", "--test", "part=0,1"), "from 0 to 1"),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_bad_option_is_refused_with_a_hint(tmp_path: Path, name: str) -> None:
    options, hint = OPTIONS[name]
    (tmp_path / "good.csv").write_text(GOOD)
    with pytest.raises(UsageError) as caught:
        read(tmp_path / "good.csv", *options)
    assert hint in str(caught.value) and "\n" not in str(caught.value)


def test_all_units_that_are_missing_or_wrong_are_told_at_once(tmp_path: Path) -> None:
    (tmp_path / "bare.csv").write_text(text_of(samples(), ("t", "x", "f", "i_a")))
    with pytest.raises(UsageError) as caught:
        read(tmp_path / "bare.csv")
    for role, name in (("time", "t"), ("displacement", "x"), ("force", "f")):
        assert f"--{role} '{name}:UNIT'" in str(caught.value)
    assert str(caught.value).count("bare.csv:1") == 1
    with pytest.raises(UsageError, match="'day'.*'stone'"):
        read(tmp_path / "bare.csv", "--time", "t:day", "--force", "f:stone")
    (tmp_path / "columns.toml").write_text('columns = { time = "t:day", force = "f:stone" }\n')
    with pytest.raises(UsageError, match="'day'.*'stone'"):
        read(tmp_path / "bare.csv", "--columns", str(tmp_path / "columns.toml"))


def test_same_file_twice_is_refused(tmp_path: Path) -> None:
    (tmp_path / "good.csv").write_text(GOOD)
    with pytest.raises(UsageError, match="named twice"):
        read([tmp_path / "good.csv", tmp_path / "good.csv"])


def test_several_files_without_a_command_are_refused(tmp_path: Path) -> None:
    rows = [row[:3] for row in samples()]
    for name in "ab":
        (tmp_path / f"{name}.csv").write_text(text_of(rows, HEAD[:3]))
    with pytest.raises(UsageError, match="state the current of each"):
        read([tmp_path / "a.csv", tmp_path / "b.csv"])


MAPPINGS: dict[str, tuple[str, str]] = {
    "not TOML": ("columns = ", "--columns takes a TOML file"),
    "unknown key": ("colums = {}", "unknown key 'colums'"),
    "unknown role": ("columns = { power = 'p' }", "no role 'power'"),
    "role of a wrong kind": ("columns = { force = 3 }", "force has to be 'NAME'"),
    "unit": ("columns = { force = { column = 'force_n', unit = 'm' } }", "no unit of force"),
    "scale": ("columns = { force = { column = 'force_n', scale = 0 } }", "leaves nothing"),
    "columns": ("columns = 3", "has to be a table"),
    "flag": ("flip_force = 1", "true or false"),
    "number": ("rate_Hz = 'fast'", "has to be a number"),
    "negative": ("low_pass_Hz = -1.0", "above 0"),
    "current": ("current_A = nan", "has to be a number"),
    "group": ("group = 'a'", "list of column names"),
    "average": ("output_average = { periods = 1.0 }", "output_average is"),
    "split": ("train = { part = [0, 0.5] }", "go together"),
    "part": ("train = { part = 3 }\ntest = { part = [0, 1] }", "a list of numbers"),
    "empty sets": ("set = []", "a list of tables"),
    "sets of other files": (
        "[[set]]\nfile = 'a/x.csv'\n[[set]]\nfile = 'a/y.csv'", "0 of its 2 sets are for good.csv",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MAPPINGS)
def test_bad_mapping_is_refused_with_a_hint(tmp_path: Path, name: str) -> None:
    text, hint = MAPPINGS[name]
    (tmp_path / "good.csv").write_text(GOOD)
    (tmp_path / "map.toml").write_text(text)
    with pytest.raises(UsageError) as caught:
        read(tmp_path / "good.csv", "--columns", str(tmp_path / "map.toml"))
    assert hint in str(caught.value) and "\n" not in str(caught.value)


# Random damage


def damaged(data: bytes, chance: random.Random) -> bytes:
    """One to eight random changes: bytes, cuts, copies, words that mean something to a parser."""
    words = [b",", b";", b"\n", b"\r", b'"', b"nan", b"1e308", b"-", b"\xff", b"\0", b"1,5", b"\t"]
    for _ in range(chance.randint(1, 8)):
        first = chance.randrange(len(data) + 1)
        end = min(len(data), first + chance.choice((0, 1, 2, 30, 400)))
        kind = chance.randrange(4)
        if kind == 0:
            data = data[:first] + chance.choice(words) + data[end:]
        elif kind == 1:
            data = data[:first] + bytes(chance.choices(range(256), k=3)) + data[first:]
        elif kind == 2:
            data = data[:first] + data[end:]
        else:
            data = data[:end] + data[first:end] + data[end:]
    return data


@pytest.mark.parametrize("seed", range(8))
def test_damaged_bytes_end_in_a_message_or_in_finite_records(tmp_path: Path, seed: int) -> None:
    chance = random.Random(seed)
    source = with_velocity(1.0) if seed % 2 else GOOD.replace(",", ";")
    options = ((), ("--split-gaps",), ("--work-rate-hz", "100"), ("--accept-values",))[seed % 4]
    file = tmp_path / "damaged.csv"
    outcomes = set()
    for _ in range(60):
        file.write_bytes(damaged(source.encode(), chance))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                records = read(file, *options).records
        except UsageError as error:
            assert str(error) and "\n" not in str(error)
            outcomes.add("refused")
        else:
            outcomes.add("read")
            for record in records:
                for values in (record.disp_m, record.accel_m_s2, record.force_N):
                    assert len(values) == len(record) and abs(values).max() < float("inf")
    assert "refused" in outcomes
