"""`quiesce completion`: what a shell completes with the script that it prints."""

import subprocess
from pathlib import Path

import pytest
from quiesce.cli.completion import SHELLS
from quiesce.cli.main import COMMANDS, main

# Words after the script's file: what is typed so far; the last one is completed.
ASK = """source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=()
_shtab_quiesce quiesce; printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture(scope="module")
def script(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("completion") / "quiesce.bash"
    with pytest.MonkeyPatch.context() as patch, file.open("w") as out:
        patch.setattr("sys.stdout", out)
        assert main(["completion", "bash"]) == 0
    return file


def completed(script: Path, words: str, folder: Path) -> list[str]:
    call = ["bash", "-c", ASK, "bash", str(script), "quiesce", *words.split(" ")]
    text = subprocess.run(call, capture_output=True, text=True, check=True, cwd=folder).stdout
    return text.split()


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("ru", ["rules"]),
        ("rules ch", ["check"]),
        ("rules check --qu", ["--quick"]),
        ("identify pl", ["plan"]),
        ("identify plan --stro", ["--stroke-mm"]),
        ("identify --mod", ["--model"]),
        ("law fit --kind ta", ["tanh"]),
        ("tune la", ["law"]),
        ("completion z", ["zsh"]),
        ("replay pre", ["press.csv"]),
        ("hil --out pl", ["plots"]),
        ("xyzzy --qu", []),
    ],
)
def test_bash_completes(words: str, found: list[str], script: Path, tmp_path: Path) -> None:
    (tmp_path / "press.csv").touch()
    (tmp_path / "plots").mkdir()
    assert completed(script, words, tmp_path) == found


def test_bash_completes_every_command(script: Path, tmp_path: Path) -> None:
    found = completed(script, "", tmp_path)
    assert {name for name, _, _ in COMMANDS} <= set(found)
    assert not [name for name in found if name.startswith(("identify-", "tune-"))]


@pytest.mark.parametrize("shell", SHELLS)
def test_every_shell_has_a_script(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    out = capsys.readouterr().out
    assert all(word in out for word in ("optimize", "stroke-mm", "max-current-A"))


def test_another_shell_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "ksh"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
