/// Where a GPIO line is. What both versions of libgpiod do alike.
#ifndef GPIO_PLACE_H
#define GPIO_PLACE_H

#include "gpio.h"

/// The name that others see as the line's holder.
#define GPIO_CONSUMER "quiesced"

#define GPIO_PATH_BYTES 64

typedef struct {
    char chip[GPIO_PATH_BYTES]; ///< "/dev/gpiochip0"
    unsigned int offset;
} gpio_place_t;

/// How many lines of a chip have the name, and the offset of the last one; -1 and errno where the
/// chip cannot be asked.
typedef int (*gpio_find_t)(const char *chip, const char *name, unsigned int *offset);

/// The line's place. A name is looked for on every chip and must be there once.
/// Returns false iff the specification is malformed or there is no such line, or more than one.
bool gpio_locate(const char *line, gpio_find_t find, gpio_place_t *place, linux_error_t *error);

/// Makes reads of the file descriptor return at once. Returns false iff the system refuses.
bool gpio_do_not_block(int fd);

/// Says why a request of the line failed with an errno. consumer: the line's holder, or NULL.
/// Returns false.
bool gpio_refuse(linux_error_t *error, const char *line, int number, const char *consumer);

#endif
