"""What makes a folder of compiled rules stand alone: a program that evaluates them at points whose
answers are known, CMake for it, and a page that says how to use what."""

from collections.abc import Sequence

import numpy as np

DEMO = "demo/main.c"


def demo_c(name: str, evaluate: str, inputs: np.ndarray, outputs: np.ndarray) -> str:
    """evaluate: C, of `input` and `output`; inputs, outputs: int32 [variable, point]."""
    rows = [
        f"    {{{{{listed(inputs[:, k])}}}, {{{listed(outputs[:, k])}}}}},"
        for k in range(inputs.shape[1])
    ]
    body = "\n".join(rows)
    return f"""// Evaluates {name} at points whose answers are known:
// cc *.c demo/main.c -o demo/{name}
#include "../{name}.h"

#include <inttypes.h>
#include <stdio.h>

enum {{ INPUTS = {len(inputs)}, OUTPUTS = {len(outputs)} }};

typedef struct {{
    int32_t input[INPUTS];
    int32_t output[OUTPUTS];
}} vector_t;

static const vector_t vectors[] = {{
{body}
}};

int main(void) {{
    const unsigned count = sizeof vectors / sizeof vectors[0];
    unsigned different = 0;
    for (unsigned k = 0; k < count; k++) {{
        const int32_t *input = vectors[k].input;
        int32_t output[OUTPUTS];
        (void){evaluate};
        for (unsigned i = 0; i < INPUTS; i++) {{
            printf("%" PRId32 " ", input[i]);
        }}
        printf("->");
        for (unsigned i = 0; i < OUTPUTS; i++) {{
            different += output[i] != vectors[k].output[i];
            printf(" %" PRId32, output[i]);
        }}
        printf("\\n");
    }}
    printf("%u points, %u values that differ from what they should be\\n", count, different);
    return different == 0 ? 0 : 1;
}}
"""


def listed(values: Sequence[int]) -> str:
    return ", ".join(str(int(value)) for value in values)


def cmake_text(name: str) -> str:
    return f"""cmake_minimum_required(VERSION 3.16)
project({name} C)
file(GLOB sources CONFIGURE_DEPENDS "${{CMAKE_CURRENT_SOURCE_DIR}}/*.c")
add_library({name} STATIC ${{sources}})
target_include_directories({name} PUBLIC "${{CMAKE_CURRENT_SOURCE_DIR}}")
target_compile_features({name} PUBLIC c_std_11)
if(PROJECT_IS_TOP_LEVEL OR CMAKE_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR)
  enable_testing()
  add_executable({name}_demo demo/main.c)
  target_link_libraries({name}_demo PRIVATE {name})
  add_test(NAME {name} COMMAND {name}_demo)
endif()
"""


def page_text(name: str, call: str, units: Sequence[str]) -> str:
    """call: how C evaluates it."""
    shown = "\n".join(f"- {line}" for line in units)
    return f"""# {name}

Made by `quiesce rules compile`. C11 without a library, heap or floating point.

{shown}

```c
#include "{name}.h"

int32_t input[] = {{...}};
int32_t output[...];
uint32_t is_default = {call};
```

A bit of `is_default` says that no rule reached that output: it has its default.

Try it, and see that it answers here as it did where it was made:

```sh
cc *.c demo/main.c -o demo/{name} && ./demo/{name}
```

or `cmake -B build && cmake --build build && ctest --test-dir build`. For a device take all .c
and .h files of this folder, but not the demo's.
"""
