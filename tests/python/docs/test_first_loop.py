"""The example to start from: its own build line works, and README shows it as it is."""

import re
import subprocess
from pathlib import Path

from conftest import ROOT

SOURCE = ROOT / "examples/first_loop/first_loop.c"


def run_build_line(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """The line as it stands, at the root of the sources; what it makes goes into the folder."""
    program = folder / "first_loop"
    line = line.replace("-o first_loop ", f"-o {program} ").replace("./first_loop", str(program))
    return subprocess.run(["sh", "-c", line], cwd=ROOT, capture_output=True, text=True, timeout=120)


def test_build_line_makes_a_program_that_calms_the_structure(tmp_path: Path) -> None:
    line = re.search(r"^// (cc .*)$", SOURCE.read_text(), re.M).group(1)
    result = run_build_line(line, tmp_path)
    assert result.returncode == 0, result.stderr
    rows = re.findall(r"([\d.]+) s: ([\d.]+) Hz, ([\d.]+) m/s2, (\d+) mA", result.stdout)
    rms_m_s2 = {time: float(rms) for time, _, rms, _ in rows}
    assert float(rows[-1][1]) == 9.99
    assert rms_m_s2["4.0"] < 0.3 * rms_m_s2["2.0"]


def test_readme_shows_the_example_and_its_output(tmp_path: Path) -> None:
    marked = SOURCE.read_text().split("// [README]\n")[1].split("// [/README]")[0]
    readme = (ROOT / "README.md").read_text()
    assert f"```c\n{marked}```\n" in readme
    assert len([line for line in marked.splitlines() if line]) <= 25
