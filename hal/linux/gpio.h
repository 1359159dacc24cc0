/// GPIO lines through libgpiod. gpio_v1.c is for libgpiod 1.6, gpio_v2.c for 2.x; the build takes
/// the one that fits the library it finds.
#ifndef GPIO_H
#define GPIO_H

#include "linux_error.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gpio_line gpio_line_t;

/// A line by its name ("ESTOP") or by chip and offset ("gpiochip0:3", "/dev/gpiochip0:3").
typedef struct {
    const char *line;
    bool is_active_low;
    enum { GPIO_BIAS_AS_IS, GPIO_BIAS_PULL_UP, GPIO_BIAS_PULL_DOWN, GPIO_BIAS_OFF } bias;
} gpio_spec_t;

/// An edge as the kernel saw it.
typedef struct {
    int64_t time_ns; ///< CLOCK_MONOTONIC
    bool is_active;  ///< the level after it
} gpio_edge_t;

/// Requests the line as an output at a level. Returns NULL where there is no such line, another
/// process holds it (its name is in the error), or it cannot be an output.
gpio_line_t *gpio_open_output(const gpio_spec_t *spec, bool is_active, linux_error_t *error);

/// Requests the line as an input with both edges.
gpio_line_t *gpio_open_input(const gpio_spec_t *spec, linux_error_t *error);

/// Releases the line; NULL is allowed. What an output does then is up to its driver.
void gpio_close(gpio_line_t *line);

/// Returns false iff the kernel refuses (the chip is gone).
bool gpio_set(gpio_line_t *line, bool is_active);

/// Level now. Returns false iff the kernel refuses; *is_active is then left alone.
bool gpio_get(gpio_line_t *line, bool *is_active);

/// Next pending edge; never blocks. Returns false iff there is none (or the chip is gone: gpio_get
/// tells).
bool gpio_next_edge(gpio_line_t *line, gpio_edge_t *edge);

/// For poll(): readable when an edge is pending. -1 for outputs.
int gpio_fd(const gpio_line_t *line);

/// "libgpiod 1.6.3": what this was built for, and runs with.
const char *gpio_library(void);

#endif
