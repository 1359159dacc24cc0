// ADXL355 on spidev (Documentation/spi/spidev.rst). Untested on hardware.
#include "accel_backends.h"
#include "adxl355.h"
#include "adxl355_error.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/spi/spidev.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#define MAX_CLOCK_HZ 10000000u

struct accel_adxl355 {
    adxl355_t chip;
    int fd;
    uint32_t clock_Hz;
};

// NOLINTNEXTLINE(readability-non-const-parameter): the kernel writes to `in`
static bool exchange(void *context, const uint8_t *out, uint8_t *in, size_t bytes) {
    const accel_adxl355_t *const self = context;
    const struct spi_ioc_transfer transfer = {
        .tx_buf = (uintptr_t)out,
        .rx_buf = (uintptr_t)in,
        .len = (uint32_t)bytes,
        .speed_hz = self->clock_Hz,
        .bits_per_word = 8,
    };
    return ioctl(self->fd, SPI_IOC_MESSAGE(1), &transfer) == (int)bytes;
}

static void pause_ms(void *context, uint32_t ms) {
    const struct timespec pause = {.tv_nsec = 1000000L * (long)ms};
    (void)context;
    (void)nanosleep(&pause, NULL); // a signal cuts it short: what follows is read back anyway
}

static bool start_chip(accel_adxl355_t *self, const accel_adxl355_options_t *options,
                       linux_error_t *error) {
    const part_bus_t bus = {.exchange = exchange, .pause_ms = pause_ms, .context = self};
    part_problem_t problem = {0};
    (void)adxl355_start(&self->chip, bus, options->range_g, options->rate_Hz, &problem);
    return adxl355_explain(&problem, options->range_g, options->rate_Hz, error);
}

static bool read_accel(void *backend, hal_axis_t axis, int32_t *counts) {
    accel_adxl355_t *const self = backend;
    return adxl355_read(&self->chip, axis, counts);
}

static bool open_spi(accel_adxl355_t *self, const char *device, linux_error_t *error) {
    const uint8_t mode = SPI_MODE_0;
    const uint8_t bits = 8;
    self->fd = open(device, O_RDWR | O_CLOEXEC);
    if (self->fd < 0) {
        return linux_fail(error, "%s: %s", device, strerror(errno));
    }
    if (ioctl(self->fd, SPI_IOC_WR_MODE, &mode) != 0 ||
        ioctl(self->fd, SPI_IOC_WR_BITS_PER_WORD, &bits) != 0 ||
        ioctl(self->fd, SPI_IOC_WR_MAX_SPEED_HZ, &self->clock_Hz) != 0) {
        return linux_fail(error, "%s: not an SPI device that does mode 0 at %u Hz: %s", device,
                          self->clock_Hz, strerror(errno));
    }
    return true;
}

accel_adxl355_t *accel_adxl355_open(const accel_adxl355_options_t *options, hal_accel_t *accel,
                                    linux_error_t *error) {
    if (options->clock_Hz == 0u || options->clock_Hz > MAX_CLOCK_HZ) {
        (void)linux_fail(error, "ADXL355: clock %u Hz: must be 1 .. %u", options->clock_Hz,
                         MAX_CLOCK_HZ);
        return NULL;
    }
    accel_adxl355_t *const self = calloc(1, sizeof *self);
    if (self == NULL) {
        (void)linux_fail(error, "out of memory");
        return NULL;
    }
    self->clock_Hz = options->clock_Hz;
    if (!open_spi(self, options->device, error) || !start_chip(self, options, error)) {
        if (self->fd >= 0) {
            (void)close(self->fd);
        }
        free(self);
        return NULL;
    }
    *accel = (hal_accel_t){.read = read_accel, .backend = self};
    return self;
}

void accel_adxl355_close(accel_adxl355_t *self) {
    if (self != NULL) {
        (void)adxl355_stop(&self->chip); // nothing can be done about it
        (void)close(self->fd);
        free(self);
    }
}

uint32_t accel_adxl355_failures(const accel_adxl355_t *self) {
    return self->chip.failures;
}
