#include "gpio_place.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_OFFSET 65535

static bool is_chip(const char *line) {
    return strncmp(line, "gpiochip", strlen("gpiochip")) == 0 ||
           strncmp(line, "/dev/", strlen("/dev/")) == 0;
}

static bool parse_offset(const char *digits, unsigned int *offset) {
    char *end = NULL;
    if (digits[0] < '0' || digits[0] > '9') {
        return false;
    }
    errno = 0;
    const long value = strtol(digits, &end, 10);
    if (*end != '\0' || errno != 0 || value > MAX_OFFSET) {
        return false;
    }
    *offset = (unsigned int)value;
    return true;
}

static bool parse_chip_and_offset(const char *line, gpio_place_t *place, linux_error_t *error) {
    const char *const colon = strrchr(line, ':');
    if (colon == NULL || !parse_offset(colon + 1, &place->offset)) {
        return linux_fail(error, "GPIO line '%s': give its name, or chip and offset as gpiochip0:3",
                          line);
    }
    const char *const folder = line[0] == '/' ? "" : "/dev/";
    const int bytes =
        snprintf(place->chip, sizeof place->chip, "%s%.*s", folder, (int)(colon - line), line);
    if (bytes < 0 || (size_t)bytes >= sizeof place->chip) {
        return linux_fail(error, "GPIO line '%.40s...': the chip's name is too long", line);
    }
    return true;
}

static int select_chip(const struct dirent *entry) {
    return strncmp(entry->d_name, "gpiochip", strlen("gpiochip")) == 0;
}

typedef struct {
    int chips;
    int found;
    int refused; ///< errno of a chip that could not be asked
} search_t;

static void search_chip(const char *chip, const char *name, gpio_find_t find, search_t *search,
                        gpio_place_t *place) {
    char path[sizeof "/dev/" + sizeof((struct dirent *)0)->d_name];
    (void)snprintf(path, sizeof path, "/dev/%s", chip);
    search->chips++;
    errno = ENAMETOOLONG;
    const int lines = strlen(path) < GPIO_PATH_BYTES ? find(path, name, &place->offset) : -1;
    if (lines < 0) {
        search->refused = errno == EACCES || errno == EPERM ? errno : search->refused;
        return;
    }
    if (lines > 0) {
        (void)snprintf(place->chip, sizeof place->chip, "%.*s", GPIO_PATH_BYTES - 1, path);
    }
    search->found += lines;
}

static bool locate_by_name(const char *name, gpio_find_t find, gpio_place_t *place,
                           linux_error_t *error) {
    struct dirent **entries = NULL;
    search_t search = {0};
    const int count = scandir("/dev", &entries, select_chip, alphasort);
    for (int i = 0; i < count; i++) {
        search_chip(entries[i]->d_name, name, find, &search, place);
        free(entries[i]);
    }
    free(entries);
    if (search.found == 1) {
        return true;
    }
    if (search.found > 1) {
        return linux_fail(error,
                          "GPIO line '%s': %d lines have this name; give chip and offset instead "
                          "(gpioinfo lists them)",
                          name, search.found);
    }
    if (search.refused != 0) {
        return linux_fail(error,
                          "GPIO line '%s': /dev/gpiochip*: %s; add the user to the group gpio",
                          name, strerror(search.refused));
    }
    return linux_fail(error, "GPIO line '%s': none of %d chips has a line of this name%s", name,
                      search.chips,
                      search.chips > 0 ? " (gpioinfo lists them)" : "; there is no /dev/gpiochip0");
}

bool gpio_locate(const char *line, gpio_find_t find, gpio_place_t *place, linux_error_t *error) {
    if (line == NULL || line[0] == '\0') {
        return linux_fail(error, "GPIO line '': give its name, or chip and offset as gpiochip0:3");
    }
    return is_chip(line) ? parse_chip_and_offset(line, place, error)
                         : locate_by_name(line, find, place, error);
}

bool gpio_do_not_block(int fd) {
    const int flags = fcntl(fd, F_GETFL);
    return flags >= 0 && fcntl(fd, F_SETFL, flags | O_NONBLOCK) == 0;
}

bool gpio_refuse(linux_error_t *error, const char *line, int number, const char *consumer) {
    switch (number) {
    case EBUSY:
        return linux_fail(error,
                          "GPIO line '%s': in use by '%s'; stop that, or choose another line", line,
                          consumer != NULL ? consumer : "unknown");
    case EACCES:
    case EPERM:
        return linux_fail(error, "GPIO line '%s': %s; add the user to the group gpio", line,
                          strerror(number));
    case ENOENT:
    case ENODEV:
    case ENOTTY:
        return linux_fail(
            error, "GPIO line '%s': there is no such GPIO chip (gpiodetect lists them)", line);
    case ENXIO:
        return linux_fail(error, "GPIO line '%s': its chip gives no edges (no interrupt)", line);
    case EINVAL:
        return linux_fail(
            error, "GPIO line '%s': its chip has no such line, or not this direction or bias",
            line);
    default:
        return linux_fail(error, "GPIO line '%s': %s", line, strerror(number));
    }
}
