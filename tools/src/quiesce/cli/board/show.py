"""`quiesce board show FILE`: what a board says, in tables."""

import argparse
from typing import Any

from quiesce.base.table import format_table
from quiesce.cli.terminal import show
from quiesce.engine.bench import Bench
from quiesce.engine.board import SCALES_PER_UNIT

EPILOG = """examples:
  quiesce board show sim_hil/data/boards/two_storeys.toml

Shown are sensors and dampers, the signals that laws see, measured or made of others, and the laws
that work with them; a law that lacks a signal is refused by that signal's name.
"""

# Unit on the board -> the unit that is shown, and how many of the former it is.
SHOWN_UNITS = {
    "um/s2": ("m/s2", 1e6),
    "um/s": ("m/s", 1e6),
    "nm": ("mm", 1e6),
    "mN": ("N", 1e3),
    "mV": ("V", 1e3),
    "mdegC": ("degC", 1e3),
}
NO_LIMIT_PCT = 100
AXES = "xyz"
SENSOR_HEAD = "sensor measures of count range every held faulty latency"
DAMPER_HEAD = "damper stroke ceiling safe continuous current trip coil"

Board = dict[str, Any]


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "show",
        help="sensors, dampers, signals and laws of a board",
        description="Show what a board file describes and which laws work with it.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", metavar="FILE", help="board, TOML")
    parser.set_defaults(run=run)


def time_text(time_us: int) -> str:
    return f"{time_us / 1000:g} ms"


def amperes(current_mA: int) -> str:
    return f"{current_mA / 1000:g} A"


def range_text(sensor: Board) -> str:
    """What it can measure, from its lowest to its highest count."""
    unit, divisor = SHOWN_UNITS[sensor["unit"]]
    step = sensor["scale"] / SCALES_PER_UNIT / divisor
    ends = (
        sensor["polarity"] * step * (sign * sensor["full_scale_counts"] - sensor["offset_counts"])
        for sign in (-1, 1)
    )
    low, high = sorted(ends)
    return f"{low:.4g} .. {high:.4g} {unit}"


def place_text(sensor: Board) -> str:
    place = sensor["of"] or "-"
    return f"{place}, {AXES[sensor['axis']]}" if sensor["measures"] == "acceleration" else place


def checks_text(sensor: Board) -> str:
    """What makes it faulty, besides its age."""
    checks = []
    if sensor["stuck_us"]:
        checks.append(f"stuck {time_text(sensor['stuck_us'])}")
    if sensor["min_noise_counts"]:
        checks.append(f"noise < {sensor['min_noise_counts']}")
    if sensor["max_lost_pct"] < NO_LIMIT_PCT:
        checks.append(f"lost > {sensor['max_lost_pct']} %")
    return ", ".join(checks) or "-"


def delay_text(sensor: Board) -> str:
    """What its phase is off by: how late it is, and below which frequency it leads."""
    corner_mHz = sensor["corner_mHz"]
    late = time_text(sensor["latency_us"])
    return f"{late}, corner {corner_mHz / 1000:g} Hz" if corner_mHz else late


def sensor_row(sensor: Board) -> list[str]:
    return [
        sensor["name"],
        sensor["measures"],
        place_text(sensor),
        f"{sensor['polarity'] * sensor['scale'] / SCALES_PER_UNIT:g} {sensor['unit']}",
        range_text(sensor),
        time_text(sensor["period_us"]) if sensor["period_us"] else "each tick",
        time_text(sensor["max_age_us"]),
        checks_text(sensor),
        delay_text(sensor),
    ]


def trip_text(damper: Board) -> str:
    if not damper["trip_mA"]:
        return "-"
    return f"{amperes(damper['trip_mA'])} for {time_text(damper['trip_us'])}"


def continuous_text(damper: Board) -> str:
    """What the coil carries for ever, and its heat's time constant where that limits anything."""
    continuous = amperes(damper["continuous_mA"])
    is_limit = damper["continuous_mA"] < damper["ceiling_mA"]
    return f"{continuous}, {damper['heat_s']} s" if is_limit else continuous


def coil_text(damper: Board) -> str:
    """Its lag, and its resistance where that is known."""
    resistance = f", {damper['coil_mohm'] / 1000:g} Ohm" if damper["coil_mohm"] else ""
    return time_text(damper["coil_lag_us"]) + resistance


def damper_row(damper: Board) -> list[str]:
    return [
        damper["name"],
        f"{damper['from']} - {damper['to']}",
        amperes(damper["ceiling_mA"]),
        amperes(damper["safe_mA"]),
        continuous_text(damper),
        "measured" if damper["measures_current"] else "modelled",
        trip_text(damper),
        coil_text(damper),
    ]


def signal_rows(signals: list[str]) -> list[list[str]]:
    """One row a quantity: of which bodies or dampers it is known."""
    places: dict[str, list[str]] = {}
    for signal in signals:
        quantity, _, place = signal.partition(" of ")
        places.setdefault(quantity, []).append(place)
    return [[quantity, ", ".join(filter(None, of)) or "-"] for quantity, of in places.items()]


def law_rows(laws: dict[str, str | None]) -> list[list[str]]:
    return [[law, f"no: lacks {lack}" if lack else "yes"] for law, lack in laws.items()]


def described(board: Board) -> str:
    tables = [
        format_table(head.split(), rows, range(9))
        for head, rows in (
            (SENSOR_HEAD, map(sensor_row, board["sensors"])),
            (DAMPER_HEAD, map(damper_row, board["dampers"])),
            ("signal of", signal_rows(board["signals"])),
            ("law possible", law_rows(board["laws"])),
        )
    ]
    head = (
        f"{board['name']}: bodies {', '.join(board['bodies'])}; "
        f"tracked {board['sensors'][board['tracked']]['name']}; "
        f"bus {time_text(board['bus_latency_us'])}; CRC-32 0x{board['crc32']:08x}"
    )
    return "\n\n".join([head, *tables])


def run(args: argparse.Namespace) -> int:
    show(described(Bench().json("board-check", args.file)))
    return 0
