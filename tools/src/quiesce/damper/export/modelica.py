"""A model of equations as a Modelica package that needs no library."""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.command_range import command_kind, command_unit, largest_command
from quiesce.damper.export.c_names import facts, filled, literal, title_of
from quiesce.damper.export.graph import (
    Equations,
    Language,
    Node,
    Written,
    equations,
    folded,
    functions,
    written,
)
from quiesce.damper.export.laws import Law, SPEED_m_s, field_of, laws_of
from quiesce.damper.export.vectors import STATED
from quiesce.damper.library import models
from quiesce.damper.model_file import DamperModel

# A lag of 0 beside one that is not: a state cannot jump.
SHORTEST_s = 1e-4

PACKAGE = """within;
package $NAME "$TITLE"
  // Made by 'quiesce identify export'. SI units; a force > 0 resists a positive velocity.
$FACTS

  model Force "force of a motion and of the $KIND that the driver is asked for"
    input Real x "displacement from mid-stroke, m";
    input Real v "velocity, m/s";
$ACCEL    input Real command "$KIND that the driver is asked for, $UNIT";
    output Real force "N";
$PARAMETERS
$VARIABLES
$INITIAL  equation
$EQUATIONS
  end Force;

  connector Flange "as Modelica.Mechanics.Translational.Interfaces.Flange_a and Flange_b"
    Real s "position, m";
    flow Real f "force into the component, N";
  end Flange;

  model Damper "between two flanges; x is 0 where they are s_rel0 apart"
    Flange flange_a;
    Flange flange_b;
    input Real command "$KIND that the driver is asked for, $UNIT";
    parameter Real s_rel0 = 0.0 "distance of the flanges in mid-stroke, m";
    Force law;
    Real v_rel "velocity at which the flanges part, m/s";
  equation
    law.x = flange_b.s - flange_a.s - s_rel0;
    v_rel = der(law.x);
    law.v = v_rel;
$FLANGE_ACCEL    law.command = command;
    flange_b.f = law.force;
    flange_a.f = -law.force;
  end Damper;

  model Example "a sine at half of the speed that the file states, while the command moves"
    parameter Real amplitude = $AMPLITUDE "m";
    parameter Real w = $OMEGA "rad/s";
    parameter Real level = $LEVEL "half of the largest command, $UNIT";
    Force law;
    Real force "N";
  equation
    law.x = amplitude * sin(w * time);
    law.v = amplitude * w * cos(w * time);
$EXAMPLE_ACCEL    law.command = level * (1.0 + sin(0.5 * w * time));
    force = law.force;
    annotation(experiment(StopTime = $STOP, Tolerance = 1e-8));
  end Example;
end $NAME;
"""

INITIAL = """  initial equation
    coil = command; // it starts there, without a lag
"""

_CALLS = {
    "absolute": "abs({0})",
    "with_sign_of": "(if {1} >= 0.0 then {0} else -({0}))",
    "smaller": "min({0}, {1})",
    "larger": "max({0}, {1})",
    "clipped": "min(max({0}, {1}), {2})",
    "sign": "sign({0})",
    "exponential": "exp({0})",
    "logarithm": "log({0})",
    "power": "({0})^({1})",
    "hyperbolic_tangent": "tanh({0})",
    "arctangent": "atan({0})",
    "sine": "sin({0})",
    "square_root": "sqrt({0})",
    "select": "noEvent(if {0} then {1} else {2})",
}


_KEYWORDS = frozenset(
    "algorithm and annotation assert block break class connect connector constant "
    "constrainedby der discrete each else elseif elsewhen encapsulated end enumeration equation "
    "expandable extends "
    "external false final flow for function if import impure in initial inner input loop model "
    "not operator or outer output package parameter partial protected public pure record redeclare "
    "replaceable return stream then true type when while within Real Integer Boolean String "
    "Modelica time".split()
)


def modelica_name(stem: str) -> str:
    """The package's name, from a file's, which have to be one. UsageError where it cannot be."""
    if not re.fullmatch(r"[A-Za-z]\w*", stem, flags=re.ASCII) or stem in _KEYWORDS:
        raise UsageError(
            f"--out: '{stem}' is the name of a Modelica package; begin it with a letter and use "
            "letters, digits and underscores"
        )
    return stem


def leaf(node: Node) -> str:
    return literal(float(node.value)) if node.what == "number" else str(node.value)


def call(what: str, of: list[str], _value: Any) -> str:
    return _CALLS[what].format(*of)


# A minus leads an expression or stands in brackets.
MODELICA = Language(leaf, call, 3)


def modelica_package(name: str, damper: DamperModel) -> str:
    """The text of NAME.mo. UsageError for a model that is not given by equations."""
    if damper.model not in equations():
        raise UsageError(
            f"model {damper.model} is learned and has no Modelica form; --to c has one for it"
        )
    one, laws = equations()[damper.model], laws_of(damper)
    known = models().get(damper.model)
    needs_accel = known is not None and known.uses_accel
    speed_m_s = damper.speed_m_s or SPEED_m_s
    amplitude_m = min(0.5 * damper.stroke_m, speed_m_s)
    omega = 0.5 * speed_m_s / amplitude_m
    variables, lines = coil(damper)
    law_variables, law_lines = law_equations(laws)
    body_variables, body_lines = body(one)
    fields = {
        "$TITLE": quoted(f"{damper.name}: {title_of(damper)}"),
        "$FACTS": "\n".join(f"  // {line}" for line in facts(damper, title_of(damper), False)),
        "$ACCEL": '    input Real a "acceleration, m/s2";\n' if needs_accel else "",
        "$FLANGE_ACCEL": "    law.a = der(v_rel);\n" if needs_accel else "",
        "$EXAMPLE_ACCEL": "    law.a = -amplitude * w^2 * sin(w * time);\n" if needs_accel else "",
        "$PARAMETERS": "\n".join(f"    {line}" for line in parameters(damper, laws)),
        "$VARIABLES": "\n".join(
            f"    {one};" for one in [*variables, *law_variables, *body_variables]
        ),
        "$INITIAL": INITIAL if lags(damper) else "",
        "$EQUATIONS": "\n".join(
            "    " + folded(f"{line};", "    ") for line in [*lines, *law_lines, *body_lines]
        ),
        "$AMPLITUDE": literal(amplitude_m),
        "$OMEGA": literal(omega),
        "$LEVEL": literal(0.5 * (largest_command(damper) or STATED)),
        "$KIND": command_kind(damper),
        "$UNIT": command_unit(damper),
        "$STOP": literal(4.0 * np.pi / omega),
        "$NAME": name,
    }
    return filled(PACKAGE, fields)


def quoted(text: str) -> str:
    """Inside a Modelica string."""
    return " ".join(text.split()).replace("\\", "\\\\").replace('"', '\\"')


def parameters(damper: DamperModel, laws: Sequence[Law]) -> list[str]:
    lines = []
    for law in laws:
        text = quoted(f"{law.text}{', ' + law.unit if law.unit else ''}")
        if is_constant(law):
            value = float(np.clip(law.coefficients[0], law.low, law.high))
            lines.append(f'parameter Real {law.name} = {literal(value)} "{text}";')
            continue
        unit = command_unit(damper)
        powers = ("", f" a {unit}", f" a {unit}2")
        lines += [
            f'parameter Real {law.name}_{k} = {literal(value)} "{text}{power}";'
            for k, (value, power) in enumerate(zip(law.coefficients, powers, strict=True))
        ]
    for name in ("rise_s", "fall_s"):
        if lags(damper):
            value = max(float(damper.rig.get(name, 0.0)), SHORTEST_s)
            lines.append(f'parameter Real {name} = {literal(value)} "lag of the coil, s";')
    if field_of(damper)[0] > 0.0:
        names = ("exponent", "saturation", "reference")
        lines += [
            f'parameter Real field_{name} = {literal(value)} "of the field law";'
            for name, value in zip(names, field_of(damper), strict=True)
        ]
    return lines


def is_constant(law: Law) -> bool:
    return law.coefficients[1:] == (0.0, 0.0)


def lags(damper: DamperModel) -> bool:
    return any(float(damper.rig.get(name, 0.0)) > 0.0 for name in ("rise_s", "fall_s"))


def coil(damper: DamperModel) -> tuple[list[str], list[str]]:
    """Variables and equations from the command to i, the effective current."""
    kind, unit = command_kind(damper), command_unit(damper)
    variables = [
        f'Real coil "{kind} after the coil\'s lag, {unit}"', f'Real i "effective {kind}, {unit}"'
    ]  # fmt: skip
    lines = []
    if lags(damper):
        lines.append(
            "der(coil) = (command - coil) / noEvent(if command > coil then rise_s else fall_s)"
        )
    else:
        lines.append("coil = command")
    if field_of(damper)[0] > 0.0:
        law = functions()["effective"]
        renamed = tuple(
            Node("name", (), _field_name(str(node.value))) if node.what == "name" else node
            for node in law.nodes
        )
        result = written(renamed, [law.result], MODELICA, "f")
        variables += declared(result)
        lines += [f"{name} = {text}" for name, _, text in result.steps]
        lines.append(f"i = {result.roots[0]}")
    else:
        lines.append("i = coil")
    return variables, lines


def _field_name(name: str) -> str:
    return "coil" if name == "i" else f"field_{name}"


def law_equations(laws: Sequence[Law]) -> tuple[list[str], list[str]]:
    moving = [law for law in laws if not is_constant(law)]
    variables = [f'Real {law.name} "{quoted(law.text)}"' for law in moving]
    lines = [
        f"{law.name} = min(max({law.name}_0 + i * ({law.name}_1 + i * {law.name}_2), "
        f"{bracketed(law.low)}), {bracketed(law.high)})"
        for law in moving
    ]
    return variables, lines


def bracketed(value: float) -> str:
    return f"({literal(value)})" if value < 0.0 else literal(value)


def declared(result: Written) -> list[str]:
    types = {"number": "Real", "truth": "Boolean"}
    return [f"{types[kind]} {name}" for name, kind, _ in result.steps]


def body(one: Equations) -> tuple[list[str], list[str]]:
    """Variables and equations of the model itself; what it does not see has no name."""
    result = written(one.nodes, [*one.rates, one.force_N], MODELICA)
    variables = [f"Real z{k}(start = 0.0, fixed = true)" for k in range(len(one.rates))]
    variables += declared(result)
    lines = [f"{name} = {text}" for name, _, text in result.steps]
    lines += [f"der(z{k}) = {text}" for k, text in enumerate(result.roots[:-1])]
    lines.append(f"force = {result.roots[-1]}")
    return variables, lines
