"""A small campaign to make others from."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PLANTS = ROOT / "sim_hil/data/plants"

SCENARIO = f"""schema = "quiesce-scenario"
version = 1
name = "short"
plant = "{PLANTS / "squeeze_2012.toml"}"
duration_s = 0.1
[[segment]]
kind = "sine"
freq_Hz = 10.0
[[window]]
start_s = 0.05
end_s = 0.1
"""

HEAD = """schema = "quiesce-campaign"
version = 1
name = "small"
scenario = "scenario.toml"
law = "fuzzy"
figures = ["amp_um", "faults"]
"""

SAMPLING = """[sampling]
method = "monte_carlo"
cases = 24
"""

FORCE = """[[factor]]
name = "force"
key = "plant.damper.force_scale"
low = 0.8
high = 1.2
times = true
"""

FREQ = """[[factor]]
key = "scenario.segment.0.freq_Hz"
low = 5
high = 20
"""

SMALL = HEAD + SAMPLING + FORCE + FREQ


def write(folder: Path, text: str = SMALL, duration_s: float = 0.1) -> Path:
    """The campaign's file, its scenario beside it."""
    scenario = SCENARIO.replace("duration_s = 0.1", f"duration_s = {duration_s}")
    (folder / "scenario.toml").write_text(scenario, encoding="utf-8")
    file = folder / "small.toml"
    file.write_text(text, encoding="utf-8")
    return file
