"""A kernel as one C++17 source behind a C header: its equations are the library's own text."""

import re
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import root
from quiesce.damper.export.c_names import (
    CSource,
    as_comment,
    facts,
    filled,
    header_text,
    literal,
    literals,
    rig_values,
)
from quiesce.damper.library import Model
from quiesce.damper.model_file import DamperModel

_INCLUDE = re.compile(r'^#include ([<"])([^>"]+)[>"][^\n]*\n', re.MULTILINE)
_STRUCT = re.compile(r"\bstruct\s+(\w+)[^;{]*\{")

SOURCE = """// Made by 'quiesce identify export'. C++17, needs nothing else; C calls it by $NAME.h.
//   c++ -std=c++17 -O2 -c $NAME.cpp
$FACTS
#include "$NAME.h"

$SYSTEM

// The library's own text: elementary functions, field law, and the model.
namespace $NAME_model {

$TEXT
} // namespace $NAME_model

namespace {

using namespace $NAME_model::quiesce;
using Kernel = $STRUCT;

constexpr std::size_t kCount = Kernel::kParameters.size();
constexpr std::size_t kSlots = Kernel::kStates > 0 ? Kernel::kStates : 1;
static_assert(kSlots == $NAME_STATES, "header and source belong together");

// Coefficients of each parameter against the effective current, ascending.
constexpr double kLaws[kCount][3] = {
$LAWS
};
constexpr FieldLaw<double> kField{$FIELD};
constexpr double kRise_s = $RISE;
constexpr double kFall_s = $FALL;
constexpr double kInertia_kg = $INERTIA;
constexpr double kSkew_s = $SKEW;
constexpr double kOffset_N = $OFFSET;
constexpr double kDrift_N_s = $DRIFT;
constexpr double kSpeed_m_s = $SPEED;
constexpr double kStepRate = 1.0; // of the fastest state; stable below 2.78
constexpr double kMostSteps = 2000.0;

struct Sample {
    double x, v, a, command;
};

void parameters(double coil_current_A, double *p) {
    const double i = kField.effective(coil_current_A);
    for (std::size_t k = 0; k < kCount; ++k) {
        const double value = kLaws[k][0] + i * (kLaws[k][1] + i * kLaws[k][2]);
        p[k] = clipped(value, Kernel::kParameters[k].min, Kernel::kParameters[k].max);
    }
}

double cubic(double from, double slope_from, double to, double slope_to, double width, double u) {
    const double rise = to - from;
    const double a = slope_from * width - rise;
    const double b = rise - slope_to * width;
    return from + u * rise + u * (1.0 - u) * ((1.0 - u) * a + u * b);
}

Sample between(const Sample &from, const Sample &to, double dt_s, double u) {
    return {cubic(from.x, from.v, to.x, to.v, dt_s, u), cubic(from.v, from.a, to.v, to.a, dt_s, u),
            from.a + u * (to.a - from.a), from.command + u * (to.command - from.command)};
}

Motion<double> seen(const Sample &s, double current_A) {
    return {s.x - kSkew_s * s.v, s.v - kSkew_s * s.a, s.a, current_A};
}

double lagged(double from_A, double to_A, double half_s, double current_A) {
    const double target_A = 0.5 * (from_A + to_A);
    const double time_s = target_A > current_A ? kRise_s : kFall_s;
    if (!(time_s > 1e-9)) {
        return to_A;
    }
    return target_A + (current_A - target_A) * exponential(-half_s / time_s);
}

double force_N(const Sample &at, double current_A, const double *z, double *rates) {
    double p[kCount];
    parameters(current_A, p);
    return Kernel::force_N(p, seen(at, current_A), z, rates);
}

// Rates up to which the states have to be followed, at either of two currents.
double steps_for(double one_A, double other_A, double dt_s) {
    double p[kCount];
    parameters(one_A, p);
    double fastest = Kernel::fastest_rate_1_s(p, kSpeed_m_s);
    parameters(other_A, p);
    fastest = larger(fastest, Kernel::fastest_rate_1_s(p, kSpeed_m_s));
    return clipped(std::ceil(fastest * dt_s / kStepRate), 1.0, kMostSteps);
}

// Classical Runge-Kutta.
void advance(double *z, double &current_A, const Sample &from, const Sample &middle,
             const Sample &to, double step_s) {
    const double middle_A = lagged(from.command, middle.command, 0.5 * step_s, current_A);
    const double end_A = lagged(middle.command, to.command, 0.5 * step_s, middle_A);
    double k1[kSlots]{}, k2[kSlots]{}, k3[kSlots]{}, k4[kSlots]{}, moved[kSlots]{};
    const auto move = [&](double step, const double *rates) {
        for (std::size_t k = 0; k < kSlots; ++k) {
            moved[k] = z[k] + step * rates[k];
        }
    };
    force_N(from, current_A, z, k1);
    move(0.5 * step_s, k1);
    force_N(middle, middle_A, moved, k2);
    move(0.5 * step_s, k2);
    force_N(middle, middle_A, moved, k3);
    move(step_s, k3);
    force_N(to, end_A, moved, k4);
    for (std::size_t k = 0; k < kSlots; ++k) {
        z[k] += step_s / 6.0 * (k1[k] + 2.0 * (k2[k] + k3[k]) + k4[k]);
    }
    current_A = end_A;
}

} // namespace

extern "C" void $NAME_reset($NAME_state *state) {
    *state = $NAME_state{};
}

extern "C" double $NAME_step($NAME_state *state, double x_m, double v_m_s, double a_m_s2,
                             double command_A, double dt_s) {
    const Sample now{x_m, v_m_s, a_m_s2, command_A};
    if (state->is_started != 0) {
        const Sample last{state->x_m, state->v_m_s, state->a_m_s2, state->command_A};
        const double steps = steps_for(last.command, command_A, dt_s);
        const int count = static_cast<int>(steps);
        for (int k = 0; k < count; ++k) {
            advance(state->z, state->current_A, between(last, now, dt_s, k / steps),
                    between(last, now, dt_s, (k + 0.5) / steps),
                    between(last, now, dt_s, (k + 1) / steps), dt_s / steps);
        }
        state->elapsed_s += dt_s;
    } else {
        state->current_A = command_A;
        state->is_started = 1;
    }
    state->x_m = x_m;
    state->v_m_s = v_m_s;
    state->a_m_s2 = a_m_s2;
    state->command_A = command_A;
    double rates[kSlots]{};
    return force_N(now, state->current_A, state->z, rates) + kInertia_kg * a_m_s2 + kOffset_N +
           kDrift_N_s * state->elapsed_s;
}
"""


def kernel_source(name: str, damper: DamperModel, with_rig: bool) -> CSource:
    """The texts of NAME.h and NAME.cpp."""
    one, orders, row = damper.kernel_row()
    file, struct = kernel_file(one)
    text, system = flattened([damper_folder() / "field_law.h", file])
    rig = rig_values(damper, with_rig)
    field = [rig.get(f"field_{key}", 0.0) for key in ("exponent", "saturation", "ref_A")]
    fields = {
        "$FACTS": as_comment(facts(damper, one.title, with_rig), "//"),
        "$SYSTEM": "\n".join(f"#include <{header}>" for header in system),
        "$TEXT": text,
        "$STRUCT": struct,
        "$LAWS": law_lines(one, orders, row),
        "$FIELD": literals(field),
        "$RISE": literal(rig["rise_s"]),
        "$FALL": literal(rig["fall_s"]),
        "$INERTIA": literal(rig["inertia_kg"]),
        "$SKEW": literal(rig["skew_s"]),
        "$OFFSET": literal(rig["offset_N"]),
        "$DRIFT": literal(rig["drift_N_s"]),
        "$SPEED": literal(damper.speed_m_s),
        "$NAME": name,
    }
    header = header_text(name, damper, one.title, max(1, one.states), one.uses_accel, with_rig)
    return CSource(header, filled(SOURCE, fields), ".cpp")


def law_lines(one: Model, orders: list[int], row: list[float]) -> str:
    lines, first = [], 0
    for parameter, order in zip(one.parameters, orders, strict=True):
        law = [*row[first : first + order], 0.0, 0.0][:3]
        lines.append(f"    {{{literals(law)}}}, // {parameter.name}: {parameter.text}")
        first += order
    return "\n".join(lines)


def damper_folder() -> Path:
    return root() / "sim_hil/damper"


def kernel_file(one: Model) -> tuple[Path, str]:
    """The header that holds a model, and its struct."""
    mark = re.compile(rf'\bkName\s*=\s*"{re.escape(one.name)}"')
    for file in sorted((damper_folder() / "kernels").glob("*.h")):
        text = file.read_text(encoding="utf-8")
        if found := mark.search(text):
            structs = _STRUCT.findall(text[: found.start()])
            if structs:
                return file, structs[-1]
    raise UsageError(
        f"the sources of model {one.name} are not in {damper_folder()}; export needs the project's "
        "source folder (QUIESCE_ROOT)"
    )


def flattened(files: list[Path]) -> tuple[str, list[str]]:
    """The files with all project headers that they include, each once, in their order; and the
    system headers."""
    seen: set[str] = set()
    system: set[str] = {"cmath", "cstddef"}
    parts: list[str] = []

    def add(file: Path) -> None:
        if file.name in seen:
            return
        seen.add(file.name)
        text = file.read_text(encoding="utf-8")
        for kind, name in _INCLUDE.findall(text):
            if kind == "<":
                system.add(name)
            else:
                add(header_named(file, name))
        # Constants that this model does not need are no reason for a warning.
        text = re.sub(r"^constexpr ", "inline constexpr ", text, flags=re.MULTILINE)
        parts.append(_INCLUDE.sub("", text).strip() + "\n")

    for file in files:
        add(file)
    return "\n".join(parts), sorted(system)


def header_named(file: Path, name: str) -> Path:
    for folder in (file.parent, damper_folder(), damper_folder() / "kernels"):
        if (folder / name).is_file():
            return folder / name
    raise UsageError(f"{file} includes {name}, which is not there; restore the source folder")
