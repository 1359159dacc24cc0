"""pytest's fixture `rig`: one test file for every rig there is. `pytest -p quiesce.rig.plugin`

Which rig: `--rig WHERE`, else the environment variable QUIESCE_RIG, else the ini option
`quiesce_rig`, else `host` (quiesce.rig.opening).
"""

import os
from collections.abc import Iterator

import pytest

from quiesce.base.errors import UsageError
from quiesce.rig.access import Rig
from quiesce.rig.opening import open_rig
from quiesce.rig.options import HOST

VARIABLE = "QUIESCE_RIG"


def pytest_addoption(parser: pytest.Parser) -> None:
    text = "rig of the fixture `rig`: host, mps2, linux, INTERFACE:CHANNEL or a file .toml"
    parser.getgroup("quiesce").addoption("--rig", metavar="WHERE", help=text)
    parser.addini("quiesce_rig", text, default="")


@pytest.fixture(scope="module")
def rig(request: pytest.FixtureRequest) -> Iterator[Rig]:
    """At work for the tests of a module."""
    config = request.config
    where = config.getoption("--rig") or os.environ.get(VARIABLE) or config.getini("quiesce_rig")
    try:
        opened = open_rig(where or HOST).__enter__()
    except UsageError as error:
        pytest.fail(str(error), pytrace=False)
    try:
        yield opened
    finally:
        opened.__exit__()
