/// A hardware watchdog (/dev/watchdog, softdog too): where it is not fed in time the machine
/// resets, and with it every output.
#ifndef WATCHDOG_H
#define WATCHDOG_H

#include "linux_error.h"

#include <stdint.h>

typedef struct watchdog watchdog_t;

/// Starts it. Returns NULL where there is none, another process holds it or the timeout is refused.
watchdog_t *watchdog_open(const char *device, int timeout_s, linux_error_t *error);

/// Once a tick; feeds it at a quarter of its timeout. now_ns: CLOCK_MONOTONIC.
void watchdog_feed(watchdog_t *self, long long now_ns);

/// Stops it (magic close) where the driver allows that. NULL is allowed.
void watchdog_close(watchdog_t *self);

/// In force: a driver may round what it was asked for.
int watchdog_timeout_s(const watchdog_t *self);

/// Feeds that the driver refused, saturating.
uint32_t watchdog_failures(const watchdog_t *self);

#endif
