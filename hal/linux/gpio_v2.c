// GPIO lines through libgpiod 2.x. Edge time stamps are CLOCK_MONOTONIC by default.
#include "gpio.h"
#include "gpio_place.h"

#include <errno.h>
#include <gpiod.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct gpio_line {
    struct gpiod_line_request *request;
    struct gpiod_edge_event_buffer *event; ///< room for one; NULL for outputs
    unsigned int offset;
    int fd;
};

static bool has_name(struct gpiod_chip *chip, unsigned int offset, const char *name) {
    struct gpiod_line_info *const line = gpiod_chip_get_line_info(chip, offset);
    const char *const line_name = line != NULL ? gpiod_line_info_get_name(line) : NULL;
    const bool is_same = line_name != NULL && strcmp(line_name, name) == 0;
    gpiod_line_info_free(line);
    return is_same;
}

static int find(const char *chip_path, const char *name, unsigned int *offset) {
    struct gpiod_chip *const chip = gpiod_chip_open(chip_path);
    int found = 0;
    if (chip == NULL) {
        return -1;
    }
    struct gpiod_chip_info *const info = gpiod_chip_get_info(chip);
    const size_t lines = info != NULL ? gpiod_chip_info_get_num_lines(info) : 0u;
    gpiod_chip_info_free(info);
    for (unsigned int i = 0; i < lines; i++) {
        if (has_name(chip, i, name)) {
            *offset = i;
            found++;
        }
    }
    gpiod_chip_close(chip);
    return found;
}

static struct gpiod_line_settings *new_settings(const gpio_spec_t *spec, bool is_output,
                                                bool is_active) {
    static const enum gpiod_line_bias bias[] = {
        [GPIO_BIAS_AS_IS] = GPIOD_LINE_BIAS_AS_IS,
        [GPIO_BIAS_PULL_UP] = GPIOD_LINE_BIAS_PULL_UP,
        [GPIO_BIAS_PULL_DOWN] = GPIOD_LINE_BIAS_PULL_DOWN,
        [GPIO_BIAS_OFF] = GPIOD_LINE_BIAS_DISABLED,
    };
    struct gpiod_line_settings *const settings = gpiod_line_settings_new();
    if (settings == NULL) {
        return NULL;
    }
    gpiod_line_settings_set_active_low(settings, spec->is_active_low);
    int refused = gpiod_line_settings_set_bias(settings, bias[spec->bias]);
    if (is_output) {
        refused |= gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_OUTPUT);
        refused |= gpiod_line_settings_set_output_value(
            settings, is_active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE);
    } else {
        refused |= gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_INPUT);
        refused |= gpiod_line_settings_set_edge_detection(settings, GPIOD_LINE_EDGE_BOTH);
    }
    if (refused != 0) {
        gpiod_line_settings_free(settings);
        return NULL;
    }
    return settings;
}

/// Requests one line; NULL and errno where that fails.
static struct gpiod_line_request *request(struct gpiod_chip *chip, unsigned int offset,
                                          struct gpiod_line_settings *settings) {
    struct gpiod_line_request *made = NULL;
    struct gpiod_request_config *const config = gpiod_request_config_new();
    struct gpiod_line_config *const lines = gpiod_line_config_new();
    if (config != NULL && lines != NULL) {
        gpiod_request_config_set_consumer(config, GPIO_CONSUMER);
        if (gpiod_line_config_add_line_settings(lines, &offset, 1, settings) == 0) {
            made = gpiod_chip_request_lines(chip, config, lines);
        }
    }
    const int number = errno;
    gpiod_line_config_free(lines);
    gpiod_request_config_free(config);
    errno = number;
    return made;
}

/// Says why a request failed with the errno.
static void refuse(struct gpiod_chip *chip, const gpio_spec_t *spec, unsigned int offset,
                   int number, linux_error_t *error) {
    struct gpiod_line_info *const info = gpiod_chip_get_line_info(chip, offset);
    const char *const consumer = info != NULL ? gpiod_line_info_get_consumer(info) : NULL;
    (void)gpio_refuse(error, spec->line, number, consumer);
    gpiod_line_info_free(info);
}

static struct gpiod_line_request *request_at(const gpio_place_t *place, const gpio_spec_t *spec,
                                             struct gpiod_line_settings *settings,
                                             linux_error_t *error) {
    struct gpiod_chip *const chip = gpiod_chip_open(place->chip);
    if (chip == NULL) {
        (void)gpio_refuse(error, spec->line, errno, NULL);
        return NULL;
    }
    struct gpiod_line_request *const made = request(chip, place->offset, settings);
    if (made == NULL) {
        refuse(chip, spec, place->offset, errno, error);
    }
    gpiod_chip_close(chip);
    return made;
}

static gpio_line_t *open_line(const gpio_spec_t *spec, bool is_output, bool is_active,
                              linux_error_t *error) {
    gpio_place_t place;
    if (!gpio_locate(spec->line, find, &place, error)) {
        return NULL;
    }
    gpio_line_t *const self = calloc(1, sizeof *self);
    struct gpiod_line_settings *const settings = new_settings(spec, is_output, is_active);
    if (self == NULL || settings == NULL) {
        (void)linux_fail(error, "out of memory");
        gpiod_line_settings_free(settings);
        free(self);
        return NULL;
    }
    *self = (gpio_line_t){.offset = place.offset, .fd = -1};
    self->request = request_at(&place, spec, settings, error);
    gpiod_line_settings_free(settings);
    if (self->request == NULL) {
        free(self);
        return NULL;
    }
    return self;
}

gpio_line_t *gpio_open_output(const gpio_spec_t *spec, bool is_active, linux_error_t *error) {
    return open_line(spec, true, is_active, error);
}

gpio_line_t *gpio_open_input(const gpio_spec_t *spec, linux_error_t *error) {
    gpio_line_t *const self = open_line(spec, false, false, error);
    if (self == NULL) {
        return NULL;
    }
    self->event = gpiod_edge_event_buffer_new(1);
    self->fd = gpiod_line_request_get_fd(self->request);
    if (self->event == NULL || !gpio_do_not_block(self->fd)) {
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
    gpiod_edge_event_buffer_free(line->event);
    gpiod_line_request_release(line->request);
    free(line);
}

bool gpio_set(gpio_line_t *line, bool is_active) {
    return gpiod_line_request_set_value(line->request, line->offset,
                                        is_active ? GPIOD_LINE_VALUE_ACTIVE
                                                  : GPIOD_LINE_VALUE_INACTIVE) == 0;
}

bool gpio_get(gpio_line_t *line, bool *is_active) {
    const enum gpiod_line_value value = gpiod_line_request_get_value(line->request, line->offset);
    if (value == GPIOD_LINE_VALUE_ERROR) {
        return false;
    }
    *is_active = value == GPIOD_LINE_VALUE_ACTIVE;
    return true;
}

bool gpio_next_edge(gpio_line_t *line, gpio_edge_t *edge) {
    if (line->fd < 0 || gpiod_line_request_read_edge_events(line->request, line->event, 1) != 1) {
        return false;
    }
    struct gpiod_edge_event *const event = gpiod_edge_event_buffer_get_event(line->event, 0);
    edge->time_ns = (int64_t)gpiod_edge_event_get_timestamp_ns(event);
    edge->is_active = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE;
    return true;
}

int gpio_fd(const gpio_line_t *line) {
    return line->fd;
}

const char *gpio_library(void) {
    static char text[32];
    (void)snprintf(text, sizeof text, "libgpiod %s", gpiod_api_version());
    return text;
}
