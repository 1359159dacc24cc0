// GPIO lines through libgpiod 1.6. Its edge time stamps are CLOCK_MONOTONIC since Linux 5.7.
#include "gpio.h"
#include "gpio_place.h"

#include <errno.h>
#include <gpiod.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct gpio_line {
    struct gpiod_chip *chip;
    struct gpiod_line *line;
    int fd;
};

static int find(const char *chip_path, const char *name, unsigned int *offset) {
    struct gpiod_chip *const chip = gpiod_chip_open(chip_path);
    int found = 0;
    if (chip == NULL) {
        return -1;
    }
    for (unsigned int i = 0; i < gpiod_chip_num_lines(chip); i++) {
        struct gpiod_line *const line = gpiod_chip_get_line(chip, i);
        const char *const line_name = line != NULL ? gpiod_line_name(line) : NULL;
        if (line_name != NULL && strcmp(line_name, name) == 0) {
            *offset = i;
            found++;
        }
    }
    gpiod_chip_close(chip);
    return found;
}

static int flags_of(const gpio_spec_t *spec) {
    static const int bias[] = {
        [GPIO_BIAS_AS_IS] = 0,
        [GPIO_BIAS_PULL_UP] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP,
        [GPIO_BIAS_PULL_DOWN] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN,
        [GPIO_BIAS_OFF] = GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE,
    };
    return bias[spec->bias] | (spec->is_active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0);
}

static bool request(gpio_line_t *self, const gpio_place_t *place, const gpio_spec_t *spec,
                    const struct gpiod_line_request_config *config, bool is_active,
                    linux_error_t *error) {
    self->chip = gpiod_chip_open(place->chip);
    if (self->chip == NULL) {
        return gpio_refuse(error, spec->line, errno, NULL);
    }
    struct gpiod_line *const line = gpiod_chip_get_line(self->chip, place->offset);
    if (line == NULL) {
        return gpio_refuse(error, spec->line, errno, NULL);
    }
    if (gpiod_line_request(line, config, is_active ? 1 : 0) != 0) {
        const int number = errno;
        return gpio_refuse(error, spec->line, number, gpiod_line_consumer(line));
    }
    self->line = line;
    return true;
}

static gpio_line_t *open_line(const gpio_spec_t *spec, int type, bool is_active,
                              linux_error_t *error) {
    gpio_place_t place;
    const struct gpiod_line_request_config config = {
        .consumer = GPIO_CONSUMER, .request_type = type, .flags = flags_of(spec)};
    if (!gpio_locate(spec->line, find, &place, error)) {
        return NULL;
    }
    gpio_line_t *const self = calloc(1, sizeof *self);
    if (self == NULL) {
        (void)linux_fail(error, "out of memory");
        return NULL;
    }
    self->fd = -1;
    if (!request(self, &place, spec, &config, is_active, error)) {
        gpio_close(self);
        return NULL;
    }
    return self;
}

gpio_line_t *gpio_open_output(const gpio_spec_t *spec, bool is_active, linux_error_t *error) {
    return open_line(spec, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, is_active, error);
}

gpio_line_t *gpio_open_input(const gpio_spec_t *spec, linux_error_t *error) {
    gpio_line_t *const self = open_line(spec, GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES, false, error);
    if (self == NULL) {
        return NULL;
    }
    self->fd = gpiod_line_event_get_fd(self->line);
    if (self->fd < 0 || !gpio_do_not_block(self->fd)) {
        (void)gpio_refuse(error, spec->line, errno, NULL);
        gpio_close(self);
        return NULL;
    }
    return self;
}

void gpio_close(gpio_line_t *line) {
    if (line == NULL) {
        return;
    }
    if (line->line != NULL) {
        gpiod_line_release(line->line);
    }
    if (line->chip != NULL) {
        gpiod_chip_close(line->chip);
    }
    free(line);
}

bool gpio_set(gpio_line_t *line, bool is_active) {
    return gpiod_line_set_value(line->line, is_active ? 1 : 0) == 0;
}

bool gpio_get(gpio_line_t *line, bool *is_active) {
    const int value = gpiod_line_get_value(line->line);
    if (value >= 0) {
        *is_active = value != 0;
    }
    return value >= 0;
}

bool gpio_next_edge(gpio_line_t *line, gpio_edge_t *edge) {
    struct gpiod_line_event event;
    if (line->fd < 0 || gpiod_line_event_read_fd(line->fd, &event) != 0) {
        return false;
    }
    edge->time_ns = (int64_t)event.ts.tv_sec * 1000000000 + event.ts.tv_nsec;
    edge->is_active = event.event_type == GPIOD_LINE_EVENT_RISING_EDGE;
    return true;
}

int gpio_fd(const gpio_line_t *line) {
    return line->fd;
}

const char *gpio_library(void) {
    static char text[32];
    (void)snprintf(text, sizeof text, "libgpiod %s", gpiod_version_string());
    return text;
}
