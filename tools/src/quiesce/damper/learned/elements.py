"""Simple hysteresis elements and their states along a record, integrated as the C++ library does:
classical Runge-Kutta, motion by cubics between samples, command by straight lines.

Equations: sim_hil/damper/learned/hysteresis_network.h.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper import library
from quiesce.damper.data.record import Record


@dataclass(frozen=True)
class Elements:
    """All times in s, reaches in m; any may be empty."""

    coil_rise_s: tuple[float, ...] = ()
    coil_fall_s: tuple[float, ...] = ()
    elastic_s: tuple[float, ...] = ()
    chain_s: tuple[float, ...] = ()
    reach_m: tuple[float, ...] = ()

    @property
    def count(self) -> int:
        return sum(map(len, (self.coil_rise_s, self.elastic_s, self.chain_s, self.reach_m)))

    def fastest_1_s(self, speed_m_s: float) -> float:
        times = (*self.coil_rise_s, *self.coil_fall_s, *self.elastic_s, *self.chain_s)
        rates = [1.0 / one for one in times] + [speed_m_s / one for one in self.reach_m]
        return max(rates, default=0.0)

    def tables(self) -> dict[str, list[float]]:
        named = {
            "coil_times_s": self.coil_rise_s,
            "coil_fall_times_s": self.coil_fall_s,
            "elastic_times_s": self.elastic_s,
            "chain_times_s": self.chain_s,
            "stop_reaches_m": self.reach_m,
        }
        return {key: [float(one) for one in values] for key, values in named.items() if values}

    def _linear(self) -> tuple[np.ndarray, np.ndarray]:
        """Matrix M and vector b of the linear part of the rates, M y + b v, without the coils."""
        first = len(self.coil_rise_s)
        matrix, by_velocity = np.zeros((self.count, self.count)), np.zeros(self.count)
        for k, time_s in enumerate(self.elastic_s, first):
            matrix[k, k], by_velocity[k] = -1.0 / time_s, 1.0
        first += len(self.elastic_s)
        for k, time_s in enumerate(self.chain_s, first):
            matrix[k, k] = -1.0 / time_s
            if k == first:
                by_velocity[k] = 1.0 / time_s
            else:
                matrix[k, k - 1] = 1.0 / time_s
        by_velocity[self.count - len(self.reach_m) :] = 1.0 / np.array(self.reach_m)
        return matrix, by_velocity

    def states(self, records: Sequence[Record], steps: int) -> np.ndarray:
        """States at the samples, [records, samples, count], from rest, with `steps` integration
        steps a sample; the records have one length and one rate."""
        coils = len(self.coil_rise_s)
        rise, fall = np.array(self.coil_rise_s), np.array(self.coil_fall_s)
        matrix, by_velocity = self._linear()
        reach = np.zeros(self.count)
        reach[self.count - len(self.reach_m) :] = 1.0 / np.array(self.reach_m)

        def rates(y: np.ndarray, velocity: np.ndarray, command: np.ndarray) -> np.ndarray:
            out = y @ matrix.T + velocity[:, None] * by_velocity
            out -= np.abs(velocity)[:, None] * (reach * y)
            missing = command[:, None] - y[:, :coils]
            out[:, :coils] = missing / np.where(missing > 0.0, rise, fall)
            return out

        velocity, command = half_steps(records, steps)
        dt_s = 1.0 / (records[0].rate_Hz * steps)
        y = np.zeros((len(records), self.count))
        out = np.empty((len(records), len(records[0]), self.count))
        out[:, 0] = y
        for step in range((len(records[0]) - 1) * steps):
            v, i = velocity[:, 2 * step : 2 * step + 3], command[:, 2 * step : 2 * step + 3]
            k1 = rates(y, v[:, 0], i[:, 0])
            k2 = rates(y + 0.5 * dt_s * k1, v[:, 1], i[:, 1])
            k3 = rates(y + 0.5 * dt_s * k2, v[:, 1], i[:, 1])
            k4 = rates(y + dt_s * k3, v[:, 2], i[:, 2])
            y = y + dt_s / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
            if (step + 1) % steps == 0:
                out[:, (step + 1) // steps] = y
        return out


def half_steps(records: Sequence[Record], steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and command at every half step, both [records, 2 steps (samples - 1) + 1]."""
    velocity = np.stack([one.velocity_m_s for one in records])
    accel = np.stack([one.accel_m_s2 for one in records])
    command = np.stack([one.command for one in records])
    part = np.arange(2 * steps) / (2 * steps)
    width_s = 1.0 / records[0].rate_Hz
    start, end = velocity[:, :-1, None], velocity[:, 1:, None]
    rise = end - start
    a = accel[:, :-1, None] * width_s - rise
    b = rise - accel[:, 1:, None] * width_s
    curve = start + part * rise + part * (1.0 - part) * ((1.0 - part) * a + part * b)
    line = command[:, :-1, None] + part * (command[:, 1:, None] - command[:, :-1, None])
    count = len(records)
    return (
        np.concatenate([curve.reshape(count, -1), velocity[:, -1:]], axis=1),
        np.concatenate([line.reshape(count, -1), command[:, -1:]], axis=1),
    )


def states_of(
    elements: Elements, records: Sequence[Record], speed_m_s: float
) -> dict[int, np.ndarray]:
    """States [samples, count] by id of the record, with the steps that a model for this speed gets;
    equal lengths and rates run together."""
    groups: dict[tuple[int, float, int], list[Record]] = {}
    for record in records:
        steps = library.substeps_for(elements.fastest_1_s(speed_m_s), record.rate_Hz)
        groups.setdefault((len(record), record.rate_Hz, steps), []).append(record)
    out = {}
    for (_, _, steps), group in groups.items():
        states = elements.states(group, steps)
        out |= {id(record): states[k] for k, record in enumerate(group)}
    return out
