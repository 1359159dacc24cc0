/// A controller on a random stream, recorded.
#ifndef STREAM_H
#define STREAM_H

#include <stddef.h>

#include "draw.h"
#include "record.h"

typedef struct {
    quiesce_t controller;
    quiesce_params_t params;
    int32_t law; ///< that runs: refused parameters leave it to the defaults
    quiesce_in_t in;
    quiesce_out_t out;
    record_t record;
    vibration_t vibration;
    uint32_t seed;
    uint32_t tick; ///< of the stream; in.tick is what the controller is told
} stream_t;

/// Names the case PREFIX_NUMBER and seeds it; params: the defaults.
void stream_open(stream_t *self, const char *prefix, uint32_t number);

/// Starts the controller with params; what comes next is recorded.
void stream_start(stream_t *self);

/// One control tick with `in`: its tick number goes up by one by itself.
void stream_step(stream_t *self);

/// Prints what was recorded.
void stream_close(stream_t *self);

#endif
