"""A model of equations as plain C11: what the library's own text computes, written out."""

from collections.abc import Mapping, Sequence

from quiesce.damper.export.c_frame import (
    COIL_IN_HALVES,
    COIL_ONLY,
    RUNGE_KUTTA_WITH_COIL,
    framed,
)
from quiesce.damper.export.c_graph import functions_text, statements, taken
from quiesce.damper.export.c_names import (
    CSource,
    filled,
    header_text,
    literals,
    rig_values,
    title_of,
)
from quiesce.damper.export.graph import Equations, called_in, equations, names_in
from quiesce.damper.export.laws import Law, field_of, laws_of
from quiesce.damper.library import models
from quiesce.damper.model_file import DamperModel

MODEL = """/* Each parameter: coefficients against the effective command, ascending; its range. */
enum { PARAMETERS = $COUNT };
static const double laws[PARAMETERS][3] = {
$LAWS
};
static const double ranges[PARAMETERS][2] = {
$RANGES
};

$FUNCTIONS
static void parameters(double current_A, double *p) {
    const double i = $EFFECTIVE;
    for (int k = 0; k < PARAMETERS; ++k) {
        const double value = laws[k][0] + i * (laws[k][1] + i * laws[k][2]);
        p[k] = clipped(value, ranges[k][0], ranges[k][1]);
    }
}

/* The model: its force in N, and the rates of its states. */
static double equations(const double *p, const motion *m, const double *z, double *rates) {
$NAMES
$BODY
}

static double model_N(const motion *m, const double *z, double *rates) {
    double p[PARAMETERS];
    parameters(m->i, p);
    return equations(p, m, z, rates);
}
"""

FASTEST = """
/* Bound of how fast the states change, in 1/s. */
static double fastest_1_s(double current_A) {
    double p[PARAMETERS];
    parameters(current_A, p);
$RATE_NAMES
$RATE_BODY
}
"""


def kernel_source(name: str, damper: DamperModel, with_rig: bool) -> CSource:
    """The texts of NAME.h and NAME.c."""
    one, known = equations()[damper.model], models().get(damper.model)
    title = title_of(damper)
    rig, field = rig_values(damper, with_rig), field_of(damper)
    # The coil of a kernel lags as in the library's runs, to the last bit.
    exp, coil = ("exponential", COIL_IN_HALVES) if known else ("exp", COIL_ONLY)
    model = model_text(one, laws_of(damper), field, damper.speed_m_s, {exp} & {"exponential"})
    advance = RUNGE_KUTTA_WITH_COIL if one.rates else coil
    source = framed(name, damper, title, rig, with_rig, model, advance, exp)
    uses_accel = known is not None and known.uses_accel
    header = header_text(name, damper, title, max(1, len(one.rates)), uses_accel, with_rig)
    return CSource(header, source)


def model_text(
    one: Equations, laws: Sequence[Law], field: Sequence[float], speed_m_s: float, more: set[str]
) -> str:
    """`more`: functions that others call, too."""
    roots = [*one.rates, one.force_N]
    has_field = field[0] > 0.0
    calls = called_in(one.nodes, [*roots, one.fastest_rate_1_s]) | {"clipped"} | more
    calls |= {"effective"} if has_field else set()
    sources = {law.name: f"p[{k}]" for k, law in enumerate(laws)}
    text = MODEL + (FASTEST if one.rates else "")
    seen = {key: f"m->{key}" for key in "xvai"}
    states = {f"z{k}": f"z[{k}]" for k in range(len(one.rates))}
    targets = [*(f"rates[{k}] =" for k in range(len(one.rates))), "return"]
    names = names_in(one.nodes, roots)
    body = taken(names, sources | seen | states, ["p", "m", "z"] + ["rates"] * (not one.rates))
    fields = {
        "$COUNT": str(len(laws)),
        "$LAWS": "\n".join(
            f"    {{{literals(law.coefficients)}}}, /* {law.name}: {law.text} */" for law in laws
        ),
        "$RANGES": "\n".join(f"    {{{literals((law.low, law.high))}}}," for law in laws),
        "$FUNCTIONS": functions_text(calls),
        "$EFFECTIVE": f"effective(current_A, {literals(field)})" if has_field else "current_A",
        "$NAMES": body,
        "$BODY": statements(one.nodes, roots, targets),
    }
    return filled(text, fields | rate_fields(one, sources, speed_m_s))


def rate_fields(one: Equations, sources: Mapping[str, str], speed_m_s: float) -> dict[str, str]:
    names = names_in(one.nodes, [one.fastest_rate_1_s])
    text = taken(names, sources, [])
    if "speed" in names:
        text += f"\n    const double speed = {literals([speed_m_s])};"
    return {
        "$RATE_NAMES": text.strip("\n"),
        "$RATE_BODY": statements(one.nodes, [one.fastest_rate_1_s], ["return"]),
    }
