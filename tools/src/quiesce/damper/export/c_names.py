"""What every exported C model shares: its header, its numbers, and the names of its functions."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from quiesce.base.errors import UsageError
from quiesce.damper.command_range import command_kind, command_unit
from quiesce.damper.library import RIG, models
from quiesce.damper.model_file import DamperModel

# Files of a folder, headers of C, and what CMake, its generators and linkers mean by a target.
_TAKEN = frozenset(
    "main m all all_build zero_check test run_tests help clean depend install package "
    "package_source preinstall edit_cache rebuild_cache list_install_components "
    "assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal "
    "stdalign stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath "
    "threads time uchar wchar wctype".split()
)
_KEYWORDS = frozenset(
    "auto break case char const continue default do double else enum extern float for goto if "
    "inline int long register restrict return short signed sizeof static struct switch typedef "
    "union unsigned void volatile while bool class namespace new delete template this throw "
    "private public protected virtual operator using try catch friend export".split()
)


@dataclass(frozen=True)
class CSource:
    """Texts of a header, of a source file, and of another header that the source includes."""

    header: str
    source: str
    core: str = ""


def c_name(stem: str) -> str:
    """The prefix of all functions, from a file's name. UsageError where it cannot be one."""
    name = re.sub(r"\W", "_", stem, flags=re.ASCII)
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or name in _KEYWORDS or "__" in name:
        raise UsageError(
            f"--out: '{stem}' becomes the prefix of C functions; begin it with a letter and use "
            "letters, digits and single underscores"
        )
    if name.lower() in _TAKEN:  # some file systems do not tell Main from main
        raise UsageError(
            f"--out: '{stem}' has a meaning of its own to C or CMake; name it otherwise"
        )
    return name


def in_unit(text: str, damper: DamperModel) -> str:
    """C that is written for a current in A, with the names of the file's own command: command_V
    and voltage_V of one in V."""
    if command_unit(damper) == "A":
        return text
    return re.sub(r"\b([a-z]+)_A\b", r"\1_V", re.sub(r"\bcurrent_A\b", "voltage_V", text))


def core_name(name: str) -> str:
    """Of the header with what a learned model shares with the library."""
    return f"{name}_core.h"


def literal(value: float) -> str:
    """A double that reads back as itself."""
    text = repr(float(value))
    return text if any(mark in text for mark in ".en") else f"{text}.0"


def literals(values: Iterable[float]) -> str:
    return ", ".join(literal(value) for value in values)


def comment(text: object) -> str:
    """Text that cannot end a comment."""
    return " ".join(str(text).split()).replace("*/", "* /").replace("\\", "/")


def rig_values(damper: DamperModel, with_rig: bool) -> dict[str, float]:
    """The coil's lag and the field law always, the rest of the rig where asked for."""
    always = ("rise_s", "fall_s", *(name for name in RIG if name.startswith("field_")))
    return {
        name: float(damper.rig.get(name, 0.0)) if with_rig or name in always else 0.0
        for name in RIG
    }


def title_of(damper: DamperModel) -> str:
    known = models().get(damper.model)
    return known.title if known else damper.model.replace("_", " ")


def facts(damper: DamperModel, title: str, with_rig: bool) -> list[str]:
    """What a reader of the file has to know."""
    lines = [
        f"{comment(damper.name)}: {comment(title)}",
        f"stroke {damper.stroke_m:g} m, speed {damper.speed_m_s:g} m/s",
    ]
    for what, table in (("source", damper.source), ("valid", damper.valid)):
        pairs = table.items() if isinstance(table, Mapping) else [("text", table)]
        lines += [f"{what}, {comment(key)}: {comment(text)}" for key, text in pairs]
    left_out = [name for name in RIG[2:6] if damper.rig.get(name)] if not with_rig else []
    if left_out:
        lines.append(f"left out, of the rig it was measured on: {', '.join(left_out)}")
    return lines


def as_comment(lines: Sequence[str], mark: str) -> str:
    return "\n".join(f"{mark} {line}".rstrip() for line in lines)


HEADER = """/* Made by 'quiesce identify export'.
$FACTS
 *
 * SI units. The force resists: > 0 opposes a positive velocity. It is that of the instant of the
 * call; between two calls motion and command are interpolated. Call it at even times, at least
 * about ten times a period of the motion. Not thread-safe on one state; no memory, no globals. */
#ifndef $GUARD_H
#define $GUARD_H

#ifdef __cplusplus
extern "C" {
#endif

enum { $NAME_STATES = $SLOTS };

typedef struct {
    double z[$SLOTS];  /* hysteretic states */
    double current_A;  /* of the coil, after its lag */
    double x_m;        /* of the last call */
    double v_m_s;
    double a_m_s2;
    double command_A;
    double elapsed_s;
    int is_started;
} $NAME_state;

/* At rest. The first step takes its command as the coil's $KIND at once; what follows lags. */
void $NAME_reset($NAME_state *state);

/* Force in N. x_m: displacement from mid-stroke, v_m_s and a_m_s2: its derivatives ($ACCEL),
 * command_A: the $KIND that the driver is asked for, dt_s: time since the last call, > 0 (of the
 * first call it does not count). */
double $NAME_step($NAME_state *state, double x_m, double v_m_s, double a_m_s2, double command_A,
                  double dt_s);

#ifdef __cplusplus
}
#endif

#endif
"""


def header_text(
    name: str, damper: DamperModel, title: str, slots: int, uses_accel: bool, with_rig: bool
) -> str:
    needs_accel = uses_accel or with_rig
    fields = {
        "$FACTS": as_comment(facts(damper, title, with_rig), " *"),
        "$GUARD": name.upper(),
        "$NAME": name,
        "$SLOTS": str(slots),
        "$KIND": command_kind(damper),
        "$ACCEL": "it needs the acceleration"
        if needs_accel
        else "the acceleration helps to interpolate, 0 will do",
    }
    return filled(HEADER, fields)


def filled(text: str, fields: dict[str, str]) -> str:
    for key, value in fields.items():
        text = text.replace(key, value)
    return text
