"""The campaign that is measured: short cases of the default plant."""

from contextlib import closing
from pathlib import Path

import tomli_w
from quiesce.base.paths import default_plant
from quiesce.base.pools import Pool
from quiesce.campaign.facts import facts_of
from quiesce.campaign.file import Campaign, read_campaign
from quiesce.campaign.run import run_missing
from quiesce.campaign.store import Store

CASE_s = 0.1  # simulated


def write_campaign(folder: Path, cases: int, case_s: float = CASE_s, seed: int = 1) -> Path:
    """The file; its scenario beside it."""
    scenario = {
        "schema": "quiesce-scenario",
        "version": 1,
        "name": "short",
        "plant": str(default_plant()),
        "duration_s": case_s,
        "segment": [{"kind": "sine", "freq_Hz": 10.0}],
        "window": [{"start_s": 0.5 * case_s, "end_s": case_s}],
    }
    (folder / "scenario.toml").write_text(tomli_w.dumps(scenario), encoding="utf-8")
    campaign = {
        "schema": "quiesce-campaign",
        "version": 1,
        "name": "measured",
        "seed": seed,
        "scenario": "scenario.toml",
        "law": "fuzzy",
        "sampling": {"method": "monte_carlo", "cases": cases},
        "factor": [
            {"name": "force", "key": "plant.damper.force_scale", "low": 0.8, "high": 1.2}
            | {"times": True},
            {"name": "freq_Hz", "key": "scenario.segment.0.freq_Hz", "low": 5.0, "high": 20.0},
        ],
    }
    file = folder / "measured.toml"
    file.write_text(tomli_w.dumps(campaign), encoding="utf-8")
    return file


def open_store(campaign: Campaign, file: Path) -> Store:
    names = [factor.name for factor in campaign.design.factors]
    return Store(file, names, campaign.recipe.figures, facts_of(campaign))


def digest_on(campaign: Campaign, file: Path, pool: Pool) -> str:
    """Of all rows, made by the pool."""
    with closing(open_store(campaign, file)) as store:
        run_missing(campaign, store, pool, lambda rows, failed: None)
        return store.digest()


def campaign_in(folder: Path, cases: int, case_s: float = CASE_s, seed: int = 1) -> Campaign:
    return read_campaign(write_campaign(folder, cases, case_s, seed))
