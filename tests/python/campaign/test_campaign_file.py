"""Campaign files: what each key does to a case, and what is refused, in which words."""

from pathlib import Path

import pytest
from campaign_files import FORCE, HEAD, PLANTS, ROOT, SAMPLING, SMALL, write
from quiesce.base.errors import UsageError
from quiesce.campaign.file import read_campaign

GRID = '[sampling]\nmethod = "grid"\n'


def factor(*lines: str) -> str:
    return "[[factor]]\n" + "\n".join(lines) + "\n"


def one_value(key: str, value: str) -> str:
    return HEAD + GRID + factor(f'key = "{key}"', f"values = [{value}]")


BAD = {
    "not toml": ("name = ", "not a TOML file"),
    "another schema": (SMALL.replace("quiesce-campaign", "quiesce-plant"), "expected schema"),
    "another version": (SMALL.replace("version = 1", "version = 2"), "version = 1"),
    "unknown key": ("lwa = 1\n" + SMALL, "unknown key 'lwa'; did you mean 'law'?"),
    "no name": (SMALL.replace('name = "small"\n', "", 1), "name: expected a text, found nothing"),
    "no scenario": (SMALL.replace('"scenario.toml"', '"none.toml"'), "there is no file none.toml"),
    "no factor": (HEAD + SAMPLING, "factor: expected an array"),
    "no sampling": (HEAD + FORCE, "sampling: expected a table"),
    "no law": (SMALL.replace('law = "fuzzy"\n', ""), "law: the case has none"),
    "no such method": (SMALL.replace("monte_carlo", "sobl"), "did you mean 'sobol'?"),
    "no cases": (SMALL.replace("cases = 24", ""), "cases: expected an integer in 1 .. 10000000"),
    "cases as text": (SMALL.replace("24", '"24"'), "cases: expected an integer"),
    "too many": (SMALL.replace("24", "10000001"), "cases: expected an integer"),
    "too many by crossing": (
        SMALL.replace("24", "9000000")
        + factor('key = "law"', 'values = ["off", "fuzzy"]', "crossed = true"),
        "18000000 cases; at most",
    ),
    "no power of 2": (SMALL.replace("monte_carlo", "sobol"), "needs a power of 2"),
    "seed below 0": ("seed = -1\n" + SMALL, "seed: expected an integer"),
    "figures empty": (SMALL.replace('["amp_um", "faults"]', "[]"), "figures: expected an array"),
    "figures no text": (SMALL.replace('"faults"', "1"), "figures: expected names"),
    "worst unknown": ('worst = ["amp"]\n' + SMALL, "did you mean 'amp_um'?"),
    "twice one name": (SMALL + FORCE, "two columns would be called 'force'"),
    "name of a column": (SMALL.replace('"force"', '"Number"'), "would be called 'Number'"),
    "unknown factor key": (SMALL + "hihg = 2\n", "did you mean 'high'?"),
    "no key": (HEAD + SAMPLING + factor("low = 1", "high = 2"), "key: expected a text"),
    "unknown root": (SMALL.replace("plant.damper", "plnt.damper"), "did you mean 'plant'?"),
    "empty part": (SMALL.replace("plant.damper", "plant..damper"), "no key 'plant..damper"),
    "no such table": (SMALL.replace("plant.damper", "plant.dampre"), "plant.dampre: there is no"),
    "no such element": (SMALL.replace("segment.0", "segment.4"), "a number below 1"),
    "times nothing": (SMALL.replace("force_scale", "force_scales"), "there is no number in"),
    "part of a number": (SMALL.replace("force_scale", "force_scale.x"), "neither a table nor"),
    "low above high": (SMALL.replace("low = 0.8", "low = 1.8"), "expected low below high"),
    "low is infinite": (SMALL.replace("low = 0.8", "low = -inf"), "low: expected a number"),
    "log of nothing": (SMALL.replace("low = 0.8", "low = 0\nlog = true"), "expected low above 0"),
    "flag is a text": (SMALL.replace("times = true", 'times = "yes"'), "expected true or false"),
    "no spread": (
        HEAD + SAMPLING + factor('key = "seed"', "mean = 1", "std = 0"), "expected std > 0",
    ),
    "half an integer": (
        HEAD + SAMPLING + factor('key = "seed"', "low = 0.5", "high = 2", "integer = true"),
        "low and high as integers",
    ),
    "a grid of a range": (HEAD + GRID + FORCE, "a grid needs values, or count"),
    "morris of a normal one": (
        HEAD + SAMPLING.replace("monte_carlo", "morris")
        + factor('key = "scenario.drive_V"', "mean = 1", "std = 0.1"),
        "morris needs low and high",
    ),
    "crossed without count": (SMALL.replace("times", "crossed = true\ntimes"), "of a range"),
    "values are empty": (one_value("law", ""), "values: expected an array"),
    "values are the same": (one_value("law", '"off", "off"'), "two of its values are the same"),
    "values name no file": (one_value("plant", '"none.toml"'), "there is no file none.toml"),
    "parts of a law": (one_value("law.x", "1"), "law has no parts"),
    "parts of a parameter": (one_value("parameter.a.b", "1"), "expected parameter.NAME"),
    "times a parameter": (
        HEAD + SAMPLING + factor('key = "parameter.adapt"', "low = 1", "high = 2", "times = true"),
        "only numbers in a file",
    ),
    "choice without a set": (
        HEAD + GRID + factor('name = "a"') + '[[factor.choice]]\nlabel = "x"\n',
        "set: expected a table",
    ),
    "choice without a label": (
        HEAD + GRID + factor('name = "a"') + '[[factor.choice]]\nset = { law = "off" }\n',
        "label: expected a text",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", list(BAD))
def test_campaign_file_that_is_wrong_is_refused(name: str, tmp_path: Path) -> None:
    text, message = BAD[name]
    with pytest.raises(UsageError) as refused:
        read_campaign(write(tmp_path, text))
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_campaign_file_with_bytes_that_are_no_text_is_refused(tmp_path: Path) -> None:
    file = write(tmp_path)
    file.write_bytes(b"\xff\xfe" + file.read_bytes())
    with pytest.raises(UsageError, match="not a TOML file"):
        read_campaign(file)


def scenario_of(folder: Path, text: str, number: int = 0) -> dict:
    campaign = read_campaign(write(folder, text))
    return campaign.recipe.parts(campaign.design.case(number)).scenario


def test_factors_change_what_their_keys_name(tmp_path: Path) -> None:
    scenario = scenario_of(
        tmp_path,
        HEAD + GRID
        + factor('key = "plant.damper.force_scale"', "values = [2.0]", "times = true")
        + factor('key = "plant.structure.mode.1.freq_Hz"', "values = [4]", "plus = true")
        + factor('key = "scenario.noise_mg"', "values = [0.25]"),
    )  # fmt: skip
    assert scenario["plant"]["damper"]["force_scale"] == 2.0 * 4.74e-5
    assert [mode["freq_Hz"] for mode in scenario["plant"]["structure"]["mode"]] == [11.5, 100.0]
    assert scenario["noise_mg"] == 0.25


def test_keys_go_on_into_files_and_find_elements_by_name(tmp_path: Path) -> None:
    plant = PLANTS / "elastomer_mount.toml"
    scenario = scenario_of(
        tmp_path,
        HEAD + f'plant = "{plant}"\n' + GRID
        + factor(
            'key = "plant.damper.file.parameters.loss_factor"', "values = [2.0]", "times = true"
        ),
    )  # fmt: skip
    damper = scenario["plant"]["damper"]["file"]
    assert damper["parameters"]["loss_factor"] == pytest.approx(2.0 * loss_factor())
    storeys = PLANTS / "five_storeys.toml"
    scenario = scenario_of(
        tmp_path,
        HEAD + f'plant = "{storeys}"\n' + GRID
        + factor('key = "plant.damper.brace.parameters.fc_N"', "values = [0.5]", "times = true"),
    )  # fmt: skip
    assert scenario["plant"]["damper"][0]["parameters"]["fc_N"] == [2.5, 30.0]
    # A file that the plant names by a relative path is found from wherever the case's plant is.
    assert Path(scenario["plant"]["structure"]["mass_kg_file"]).is_file()


def loss_factor() -> float:
    import tomllib

    with (ROOT / "sim_hil/data/dampers/mre_2014.toml").open("rb") as file:
        return float(tomllib.load(file)["parameters"]["loss_factor"])


def test_a_plant_is_chosen_before_what_is_in_it(tmp_path: Path) -> None:
    text = (
        HEAD + GRID
        + factor('key = "plant.driver.max_current_A"', "values = [0.5]", "times = true")
        + factor('key = "plant"', f'values = ["{PLANTS / "frame_3dof.toml"}"]')
    )  # fmt: skip
    plant = scenario_of(tmp_path, text)["plant"]
    assert (plant["name"], plant["driver"]["max_current_A"]) == ("frame_3dof", 1.0)


def test_settings_and_tables_become_options_of_the_bench(tmp_path: Path) -> None:
    (tmp_path / "a.table").write_bytes(b"")
    text = HEAD + "[parameter]\nadapt = false\n" + GRID + factor('name = "law_of"') + """
[[factor.choice]]
label = "phase"
set = { law = "phase", pulses = "a.table", "parameter.adapt" = true, seed = 5 }
"""  # fmt: skip
    campaign = read_campaign(write(tmp_path, text))
    parts = campaign.recipe.parts(campaign.design.case(0))
    assert parts.options == {"seed": "5", "law": "phase", "pulses": str(tmp_path / "a.table")}
    assert parts.settings == {"adapt": "on"}


def test_every_file_that_a_case_reads_is_an_input(tmp_path: Path) -> None:
    text = HEAD + GRID + factor('key = "plant"', f'values = ["{PLANTS / "five_storeys.toml"}"]')
    inputs = read_campaign(write(tmp_path, text)).inputs()
    assert [file.name for file in inputs if file.parent.name == "five_storeys"] == [
        "damping.csv", "mass.csv", "stiffness.csv",
    ]  # fmt: skip
    assert {"scenario.toml", "squeeze_2012.toml", "five_storeys.toml"} <= {f.name for f in inputs}


def test_the_example_is_a_campaign() -> None:
    campaign = read_campaign(ROOT / "examples/campaign/spread.toml")
    assert len(campaign.design) == 192
    assert campaign.design.crossings == 3
