"""A table into a controller at work: sent whole, checked by the controller, used, kept."""

import time
from collections.abc import Callable

from quiesce.base.errors import BenchFailure
from quiesce.can.refusals import why_refused
from quiesce.can.roads import LEARNT
from quiesce.can.tables import CRC, STORED, Refused, Tables
from quiesce.loading.sources import Table


def put(
    tables: Tables, table: Table, tell: Callable[[str], None], is_to_be_used: bool = True
) -> float:
    """Sends it, has it checked and used. Returns the seconds that took. BenchFailure, with the
    checker's reason, where it is refused: nothing was changed."""
    road = table.road
    in_use = tables.info(road, CRC)  # answered by whoever takes tables
    tell(f"road {road} has {in_use:08x}; sending {table.kind.name} {table.crc:08x}")
    start_s = time.monotonic()
    try:
        tables.send(table.data, table.crc)
        tell("checked: the controller takes it")
        if is_to_be_used:
            tables.commit(road, table.crc)
            verify(tables, table)
            tell("in use")
    except Refused as error:
        why = why_refused(tables.services, error.verdict, table.kind)
        raise BenchFailure(f"refused: {why}; nothing was changed")
    return time.monotonic() - start_s


def verify(tables: Tables, table: Table) -> None:
    """What was learnt changes as it learns on: there is nothing to compare."""
    if table.road == LEARNT:
        return
    crc = tables.info(table.road, CRC)
    if crc != table.crc:
        raise BenchFailure(f"the controller says that it uses {crc:08x}, not {table.crc:08x}")


def save(tables: Tables, table: Table) -> None:
    """For the next start. BenchFailure where it is not stored."""
    road = table.road
    try:
        tables.save(road)
        stored = tables.info(road, STORED)
    except BenchFailure as error:
        raise BenchFailure(f"in use, but not stored for the next start: {error}")
    if road != LEARNT and stored != table.crc:
        raise BenchFailure(f"in use, but what is stored for the next start is {stored:08x}")
