"""A damper model as a folder of plain C11: header, source, a program that holds it to the bench's
own forces, CMake, README."""

from dataclasses import replace

import numpy as np

from quiesce.damper.command_range import command_kind, command_unit
from quiesce.damper.export.c_names import (
    CSource,
    comment,
    core_name,
    facts,
    filled,
    in_unit,
    literal,
    literals,
    rig_values,
    title_of,
)
from quiesce.damper.export.graph import equations
from quiesce.damper.export.kernel_c import kernel_source
from quiesce.damper.export.learned_c import learned_source
from quiesce.damper.export.vectors import Run, runs_of
from quiesce.damper.library import models
from quiesce.damper.model_file import DamperModel

TOLERANCE = 1e-12  # of the largest force

MAIN = """/* Made by 'quiesce identify export'. Holds $NAME to the forces of the bench's own model:
 * exit code 0 where each is within $TOLERANCE of the largest, else 1. */
#include "$NAME.h"

#include <math.h>
#include <stdio.h>

enum { RUNS = $RUNS, SAMPLES = $SAMPLES };

/* Time between two samples of each run. */
static const double dt_s[RUNS] = {$STEPS};
/* Displacement (m), velocity (m/s), acceleration (m/s2), command ($UNIT), expected force (N). */
static const double rows[RUNS][SAMPLES][5] = {
$ROWS
};

int main(void) {
    double largest_N = 0.0;
    double most_N = 0.0;
    for (int run = 0; run < RUNS; ++run) {
        $NAME_state state;
        $NAME_reset(&state);
        for (int k = 0; k < SAMPLES; ++k) {
            const double *row = rows[run][k];
            const double force_N = $NAME_step(&state, row[0], row[1], row[2], row[3], dt_s[run]);
            const double off_N = fabs(force_N - row[4]);
            largest_N = fmax(largest_N, fabs(row[4]));
            /* What is no number is no small difference. */
            most_N = off_N <= most_N ? most_N : off_N;
        }
    }
    const int is_right = most_N <= $TOLERANCE * largest_N;
    printf("%d forces, largest %g N, largest difference %g N: %s\\n", RUNS * SAMPLES, largest_N,
           most_N, is_right ? "as the bench's model" : "NOT the bench's model");
    return is_right ? 0 : 1;
}
"""

CMAKE = """# Made by 'quiesce identify export'.
cmake_minimum_required(VERSION 3.16)
project($NAME C)

add_library($NAME STATIC $NAME.c)
target_include_directories($NAME PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
set_target_properties($NAME PROPERTIES C_STANDARD 11 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
# No fused operations: the same bits everywhere.
target_compile_options($NAME PRIVATE -Wall -Wextra -Wpedantic -ffp-contract=off)
target_link_libraries($NAME PUBLIC m)

add_executable(${PROJECT_NAME}_check main.c)
set_target_properties(${PROJECT_NAME}_check PROPERTIES C_STANDARD 11 C_EXTENSIONS OFF)
target_link_libraries(${PROJECT_NAME}_check PRIVATE $NAME)
enable_testing()
add_test(NAME $NAME COMMAND ${PROJECT_NAME}_check)
"""

README = """# $NAME

$FACTS

Made by `quiesce identify export`. Plain C11, double precision, SI units; needs the C library with
libm and nothing else. No heap, no globals: the caller owns the state.

| file | what |
|---|---|
| `$NAME.h` | the contract: units, when to call |
| `$NAME.c` | the model |
| `main.c` | holds it to $COUNT forces of the bench's own model |
| `CMakeLists.txt` | builds both |

```c
#include "$NAME.h"

$NAME_state state;
$NAME_reset(&state); /* the first step takes its command as the coil's $KIND at once */
/* every dt_s: */
double force_N = $NAME_step(&state, x_m, v_m_s, a_m_s2, command_A, dt_s);
```

```sh
cc -std=c11 -O2 -ffp-contract=off -o check main.c $NAME.c -lm && ./check
```

`check` says how far the forces are from the bench's: $CLOSENESS on the machine that exported it.
Within 1e-12 of the largest is its bound. Fused multiply-add (`-ffp-contract`) or another libm may
take more than that; single precision does.

Where it comes from: $SOURCE.
"""


def c_folder(name: str, damper: DamperModel, with_rig: bool = False) -> dict[str, str]:
    """Names and texts. UsageError for a model without a C form."""
    source = c_source(name, damper, with_rig)
    runs = runs_of(damper if with_rig else without_rig(damper))
    title = title_of(damper)
    fields = {
        "$RUNS": str(len(runs)),
        "$SAMPLES": str(len(runs[0].force_N)),
        "$STEPS": literals(1.0 / run.record.rate_Hz for run in runs),
        "$ROWS": ",\n".join(rows_text(run) for run in runs),
        "$TOLERANCE": literal(TOLERANCE),
        "$COUNT": str(sum(len(run.force_N) for run in runs)),
        "$FACTS": "\n".join(f"- {line}" for line in facts(damper, title, with_rig)),
        "$CLOSENESS": "equal to the last bit" if damper.is_kernel else "a few last bits",
        "$SOURCE": source_of(damper),
        "$KIND": command_kind(damper),
        "$UNIT": command_unit(damper),
        "$NAME": name,
    }
    return {
        f"{name}.h": in_unit(source.header, damper),
        f"{name}.c": in_unit(source.source, damper),
        **({core_name(name): source.core} if source.core else {}),
        "main.c": filled(MAIN, fields),
        "CMakeLists.txt": filled(CMAKE, fields),
        "README.md": in_unit(filled(README, fields), damper),
    }


def c_source(name: str, damper: DamperModel, with_rig: bool = False) -> CSource:
    if damper.model in equations():
        return kernel_source(name, damper, with_rig)
    return learned_source(name, damper, with_rig)


def without_rig(damper: DamperModel) -> DamperModel:
    """With its coil's lag and field law, without what the rig adds."""
    return replace(damper, rig=rig_values(damper, False))


def source_of(damper: DamperModel) -> str:
    known = models().get(damper.model)
    return comment(known.source) if known else "the file's own [source]"


def rows_text(run: Run) -> str:
    record = run.record
    columns = (record.disp_m, record.velocity_m_s, record.accel_m_s2, record.command, run.force_N)
    rows = np.stack(columns, axis=1)
    return "    {\n" + ",\n".join(f"        {{{literals(row)}}}" for row in rows) + ",\n    }"
