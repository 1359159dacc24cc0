"""A damper model as a table of force over velocity and current, for Simulink's 2-D Lookup Table."""

import io

import numpy as np

from quiesce.damper.inverse import check_current, steady_forces
from quiesce.damper.model_file import DamperModel
from quiesce.damper.score import Simulate

SPEEDS = 24  # on each side of standstill; closer together near it, where friction changes sign
CURRENTS = 21

SCRIPT = """% Made by 'quiesce identify export --to lookup': $NAME.
% Force in N over velocity in m/s (rows) and coil current in A (columns), > 0 resists a positive
% velocity. The force of a loop that has closed, in mid-stroke of sines over half of the stroke: the
% width of the loop and the coil's lag are not in it.
data = load('$FILE.mat');
places = {data.velocity_m_s, data.current_A};
force_N = griddedInterpolant(places, data.force_N, 'linear', 'nearest');
disp(force_N(data.velocity_m_s(end), data.current_A(end)));

% In Simulink: block "2-D Lookup Table", inputs velocity and current, with
%   Table data     data.force_N
%   Breakpoints 1  data.velocity_m_s
%   Breakpoints 2  data.current_A
%   Interpolation method  Linear point-slope,  Extrapolation method  Clip
"""


def lookup_files(
    stem: str, damper: DamperModel, simulate: Simulate, max_current_A: float
) -> dict[str, bytes]:
    """STEM.mat with velocity_m_s [n], current_A [m] and force_N [n, m], and the script STEM.m that
    says how to use it. Up to the model's speed, 0 .. max_current_A."""
    check_current(max_current_A)
    speeds = damper.speed_m_s * (np.arange(1, SPEEDS + 1) / SPEEDS) ** 2
    places = np.concatenate([-speeds[::-1], speeds])
    currents_A = np.linspace(0.0, max_current_A, CURRENTS)
    found = steady_forces(damper, places, currents_A, simulate=simulate)
    force_N = np.sign(places)[:, None] * found.force_N
    # At standstill between the slowest motions to either side.
    still_N = 0.5 * (force_N[SPEEDS - 1] + force_N[SPEEDS])
    return {
        f"{stem}.mat": _mat(
            velocity_m_s=np.insert(places, SPEEDS, 0.0),
            current_A=currents_A,
            force_N=np.insert(force_N, SPEEDS, still_N, axis=0),
        ),
        f"{stem}.m": SCRIPT.replace("$NAME", _comment(damper.name)).replace("$FILE", stem).encode(),
    }


def _mat(**arrays: np.ndarray) -> bytes:
    from scipy.io import savemat

    out = io.BytesIO()
    savemat(out, arrays, oned_as="column")
    return out.getvalue()


def _comment(name: str) -> str:
    return " ".join(name.split())
