"""What a store says of how its rows were made."""

import hashlib
import os
from importlib.metadata import version

from quiesce import __version__
from quiesce.campaign.file import Campaign
from quiesce.engine.bench import bench_file


def facts_of(campaign: Campaign) -> dict[str, str]:
    """The file as it is, versions that decide about bits, and SHA-256 of the bench and of every
    input, by its path from the campaign's folder."""
    folder = campaign.file.parent
    inputs = {
        f"input {os.path.relpath(one, folder)}": hashlib.sha256(one.read_bytes()).hexdigest()
        for one in campaign.inputs()
    }
    return {
        "file": campaign.text,
        "quiesce": __version__,
        "numpy": version("numpy"),
        "scipy": version("scipy"),
        "bench": hashlib.sha256(bench_file().read_bytes()).hexdigest(),
        **inputs,
    }
