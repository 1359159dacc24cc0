"""Networks of law and tracker in words."""

from quiesce.base.table import format_table
from quiesce.law.forms.network import NetworkSection, NetworkTable, Span
from quiesce.network.layers import Dense, Layer


def described_networks(table: NetworkTable) -> list[str]:
    return [_section(i, section) for i, section in enumerate(table.sections)]


def _section(damper: int, section: NetworkSection) -> str:
    layers = ", ".join(_layer(one) for one in section.layers.layers)
    output = "conclusions of first order" if section.layers.output.order else "a sum"
    lines = [
        f"damper {damper + 1}: {layers}, then {output}; 0 .. {section.largest_mA / 1e3:g} A; some "
        f"{section.work} instructions"
    ]
    if section.delay_ticks:
        lines.append(
            f"also what its inputs were {section.delay_ticks} ticks ago, at "
            f"{section.rate_Hz} ticks a second"
        )
    if section.least_um_s:
        lines.append(f"slower than {1e-3 * section.least_um_s:g} mm/s it counts as that fast")
    rows = [[one.signal.name, *_ends(one)] for one in section.inputs]
    return "\n".join(lines) + "\n" + format_table(["signal", "from", "to"], rows, (0,))


def _layer(layer: Layer) -> str:
    if isinstance(layer, Dense):
        return f"{layer.units} {'tanh' if layer.is_tanh else 'straight'} units"
    return f"{layer.units} {'normalised ' if layer.is_normalised else ''}Gaussians"


def _ends(one: Span) -> list[str]:
    quantity = one.signal.quantity
    return [f"{end / quantity.per_unit:.4g} {quantity.unit}" for end in (one.low, one.high)]
