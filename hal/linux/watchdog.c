// Documentation/watchdog/watchdog-api.rst.
#include "watchdog.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/watchdog.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define FEEDS_A_TIMEOUT 4
#define NS_PER_S 1000000000LL

struct watchdog {
    int fd;
    int timeout_s;
    long long next_ns;
    uint32_t failures;
};

/// The driver may take another timeout than it was asked for: the one that it says counts.
static bool start(watchdog_t *self, const char *device, int timeout_s, linux_error_t *error) {
    struct watchdog_info info;
    self->timeout_s = timeout_s;
    self->fd = open(device, O_WRONLY | O_CLOEXEC);
    if (self->fd < 0) {
        return linux_fail(
            error, "watchdog %s: %s%s", device, strerror(errno),
            errno == EBUSY ? " (another process feeds it: systemd's RuntimeWatchdogSec?)" : "");
    }
    if (ioctl(self->fd, WDIOC_GETSUPPORT, &info) != 0) {
        return linux_fail(error, "watchdog %s: this is no watchdog", device);
    }
    if (ioctl(self->fd, WDIOC_SETTIMEOUT, &self->timeout_s) != 0 || self->timeout_s < 1) {
        return linux_fail(error, "watchdog %s: it refuses a timeout of %d s", device, timeout_s);
    }
    return true;
}

watchdog_t *watchdog_open(const char *device, int timeout_s, linux_error_t *error) {
    if (timeout_s < 1) {
        (void)linux_fail(error, "watchdog %s: timeout %d s: must be at least 1", device, timeout_s);
        return NULL;
    }
    watchdog_t *const self = calloc(1, sizeof *self);
    if (self == NULL) {
        (void)linux_fail(error, "out of memory");
        return NULL;
    }
    if (!start(self, device, timeout_s, error)) {
        watchdog_close(self);
        return NULL;
    }
    return self;
}

void watchdog_feed(watchdog_t *self, long long now_ns) {
    if (now_ns < self->next_ns) {
        return;
    }
    self->next_ns = now_ns + self->timeout_s * NS_PER_S / FEEDS_A_TIMEOUT;
    if (ioctl(self->fd, WDIOC_KEEPALIVE, 0) != 0) {
        self->failures += self->failures < UINT32_MAX ? 1u : 0u;
        self->next_ns = now_ns; // again in the next tick
    }
}

void watchdog_close(watchdog_t *self) {
    if (self == NULL) {
        return;
    }
    if (self->fd >= 0) {
        const char stop = 'V';
        if (write(self->fd, &stop, sizeof stop) != (ssize_t)sizeof stop) {
            self->failures++; // it goes on and resets the machine: nothing can be done about it
        }
        (void)close(self->fd);
    }
    free(self);
}

int watchdog_timeout_s(const watchdog_t *self) {
    return self->timeout_s;
}

uint32_t watchdog_failures(const watchdog_t *self) {
    return self->failures;
}
