// frame_abuse FRAMES [SEED]: single frames of an operator, a driver and a sensor, repeated,
// delayed, inserted and reordered, at random times of senders that start, jitter, stop and start
// again. Each is tried on a copy of the receiver, beside copies that never see it or see it in
// time. It has an effect where for more than a cycle
//   enable, a measurement or a sample is there that is in none of the copies and that the sender
//   himself does not give at that time, or
//   its value is used while that of a live sender would be,
// or where a fault is acknowledged that none of them acknowledges, and the operator did not press.
// (What was said last before a sender fell silent holds for the message's timeout, whoever said
// it.) A cycle is that of the slowest clock that is allowed, 9/8 of the message's. Prints one line
// of JSON; ends with 1 where a frame had an effect, of which the first are named with their seeds.
#include "can_make.h"
#include "can_receive.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#define RATE_HZ 1000u
#define CYCLES 60u      // of a stream
#define ABUSES 40u      // of a stream, at the most
#define NAMED 10u       // of those with an effect
#define DEFAULT_SEED 1u // each stream's seed is this one + its number

typedef enum { REPEATED, DELAYED, INSERTED, REORDERED, KINDS } kind_t;

static const char *const kind_names[KINDS] = {"repeated", "delayed", "inserted", "reordered"};

enum { OPERATOR, DRIVER, SENSOR, SENDERS };

static const uint32_t messages[SENDERS] = {
    QUIESCE_CAN_AT_OPERATOR_COMMAND,
    QUIESCE_CAN_AT_CURRENT_MEASURED,
    QUIESCE_CAN_AT_ACCEL_SAMPLE,
};

typedef struct {
    uint32_t sender;
    uint32_t cycle_ms;
    uint32_t timeout_ms;
    uint32_t count;
    uint32_t at_ms[CYCLES];
    can_frame_t frame[CYCLES];
    int32_t says[CYCLES]; ///< counts, mA; enable
    bool resets[CYCLES];
} stream_t;

typedef struct {
    uint32_t at_ms;
    uint32_t from_ms; ///< the copies part here
    uint32_t held;    ///< frame of the stream that does not come in its time; CYCLES: none
    int32_t says;
    can_frame_t frame;
} abuse_t;

typedef struct {
    uint32_t abused[KINDS];
    uint32_t with_effect;
    uint32_t stopped; ///< an operator or measurement that was there was not for a while: no harm
} result_t;

static uint32_t random_state;

static uint32_t random_below(uint32_t bound) {
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return random_state % bound;
}

// What it says differs from frame to frame, so that it is known whose it is.
static can_frame_t make(uint32_t sender, int32_t says, bool resets, uint8_t alive) {
    switch (sender) {
    case OPERATOR:
        return make_operator(says != 0, resets, alive % 16u);
    case DRIVER:
        return make_current((int16_t)says, alive % 16u);
    default:
        return make_accel(says, false, false, alive % 16u);
    }
}

// A sender in its cycle, some ms late now and then. It falls silent, jumps, or changes its mind.
static void make_stream(stream_t *stream, uint32_t sender) {
    const quiesce_can_message_t *row = &quiesce_can_messages[messages[sender]];
    const uint32_t jitter_ms = 1u + random_below(row->cycle_ms < 8u ? 2u : row->cycle_ms / 4u);
    uint32_t due_ms = random_below(row->cycle_ms) + 1u;
    uint8_t alive = (uint8_t)random_below(16);
    bool enable = random_below(2) != 0u;
    bool resets = random_below(2) != 0u;
    *stream = (stream_t){
        .sender = sender,
        .cycle_ms = row->cycle_ms,
        .timeout_ms = row->timeout_ms,
        .count = CYCLES,
    };
    for (uint32_t i = 0; i < CYCLES; i++) {
        const uint32_t event = random_below(40);
        due_ms += event == 0u ? random_below(2u * row->timeout_ms) : 0u;
        alive = (uint8_t)(event == 1u ? random_below(16) : (alive + 1u) % 16u);
        enable = event < 4u ? !enable : enable;
        stream->at_ms[i] = due_ms + random_below(jitter_ms);
        stream->says[i] = sender == OPERATOR ? enable : 1 + (int32_t)random_below(1u << 14);
        resets = random_below(8) == 0u ? !resets : resets;
        stream->resets[i] = resets;
        stream->frame[i] = make(sender, stream->says[i], stream->resets[i], alive);
        due_ms += row->cycle_ms;
    }
}

typedef struct {
    can_receive_t receive;
    can_node_inputs_t inputs;
    uint32_t resets;
    uint32_t next; ///< frame of the stream
} copy_t;

// What the sender says, whether the receiver takes it or not.
typedef struct {
    uint32_t next;
    uint32_t resets;
} truth_t;

// The operator presses with the last frame, and not with the one before.
static bool is_pressed(const stream_t *stream, uint32_t next) {
    return next >= 2u && !stream->resets[next - 2u] && stream->resets[next - 1u];
}

static bool is_pressing(const copy_t *copy) {
    return copy->receive.operator_command.press >= CAN_PRESS_ONCE;
}

static void step_truth(truth_t *truth, const stream_t *stream, uint32_t now_ms) {
    while (truth->next < stream->count && stream->at_ms[truth->next] <= now_ms) {
        truth->next++;
        truth->resets += is_pressed(stream, truth->next) ? 1u : 0u;
    }
}

// A tick: the stream's frames but the held one, and another one.
static void step(copy_t *copy, const stream_t *stream, uint32_t now_ms, uint32_t held,
                 const can_frame_t *other) {
    for (; copy->next < stream->count && stream->at_ms[copy->next] <= now_ms; copy->next++) {
        if (copy->next != held) {
            (void)can_receive_frame(&copy->receive, &stream->frame[copy->next]);
        }
    }
    if (other != NULL) {
        (void)can_receive_frame(&copy->receive, other);
    }
    can_receive_inputs(&copy->receive, 1, &copy->inputs);
    copy->resets += copy->inputs.fault_reset ? 1u : 0u;
}

static bool is_there(const copy_t *copy, uint32_t sender) {
    const can_node_inputs_t *const in = &copy->inputs;
    return sender == OPERATOR ? in->enable
           : sender == DRIVER ? in->driver[0].is_measured
                              : in->sensor[0].is_fresh;
}

static int32_t value(const copy_t *copy, uint32_t sender) {
    const can_node_inputs_t *const in = &copy->inputs;
    return sender == DRIVER   ? in->driver[0].current_mA
           : sender == SENSOR ? in->sensor[0].counts
                              : 0;
}

static bool is_said(const copy_t *copy, const copy_t *abused, uint32_t sender) {
    return is_there(copy, sender) && value(copy, sender) == value(abused, sender);
}

static bool is_alive(const truth_t *truth, const stream_t *stream, uint32_t now_ms,
                     uint32_t most_ms) {
    const uint32_t last = truth->next - 1u;
    return truth->next > 0u && now_ms - stream->at_ms[last] <= most_ms &&
           (stream->sender != OPERATOR || stream->says[last] != 0);
}

typedef struct {
    copy_t abused;
    copy_t lost;
    copy_t in_time;
    truth_t truth;
} trial_t;

// Nobody else has it, nor should he.
static bool is_held(const trial_t *trial, const stream_t *stream, uint32_t now_ms) {
    const uint32_t sender = stream->sender;
    return is_there(&trial->abused, sender) && !is_there(&trial->lost, sender) &&
           !is_there(&trial->in_time, sender) &&
           !is_alive(&trial->truth, stream, now_ms, stream->timeout_ms);
}

// The frame's value goes before that of a live sender: the ticks of a cycle, that of his frame
// counted.
static bool is_used(const trial_t *trial, const stream_t *stream, const abuse_t *abuse,
                    uint32_t now_ms) {
    const uint32_t sender = stream->sender;
    return sender != OPERATOR && is_there(&trial->abused, sender) &&
           value(&trial->abused, sender) == abuse->says &&
           !is_said(&trial->lost, &trial->abused, sender) &&
           !is_said(&trial->in_time, &trial->abused, sender) &&
           is_alive(&trial->truth, stream, now_ms, stream->cycle_ms * 9u / 8u - 1u) &&
           value(&trial->in_time, sender) == stream->says[trial->truth.next - 1u];
}

static uint32_t most(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

static void step_all(trial_t *trial, const stream_t *stream, const abuse_t *abuse,
                     uint32_t now_ms) {
    const can_frame_t *const frame = now_ms == abuse->at_ms ? &abuse->frame : NULL;
    step(&trial->abused, stream, now_ms, abuse->held, frame);
    step(&trial->lost, stream, now_ms, abuse->held, NULL);
    step(&trial->in_time, stream, now_ms, CYCLES, NULL);
    step_truth(&trial->truth, stream, now_ms);
}

// Runs the copies beside each other. Returns whether the frame had an effect.
static bool has_effect(const copy_t *base, const stream_t *stream, const abuse_t *abuse,
                       result_t *result) {
    static trial_t trial;
    const uint32_t end_ms = abuse->at_ms + stream->timeout_ms + 5u * stream->cycle_ms;
    uint32_t held_ms = 0;
    uint32_t used_ms = 0;
    uint32_t less_ms = 0;
    trial = (trial_t){*base, *base, *base, {base->next, base->resets + is_pressing(base)}};
    for (uint32_t now_ms = abuse->from_ms; now_ms < end_ms; now_ms++) {
        step_all(&trial, stream, abuse, now_ms);
        held_ms += is_held(&trial, stream, now_ms) ? 1u : 0u;
        used_ms += is_used(&trial, stream, abuse, now_ms) ? 1u : 0u;
        less_ms += is_there(&trial.lost, stream->sender) && !is_there(&trial.abused, stream->sender)
                       ? 1u
                       : 0u;
    }
    result->stopped += less_ms > stream->cycle_ms ? 1u : 0u;
    const uint32_t resets = most(trial.lost.resets, trial.in_time.resets);
    return most(held_ms, used_ms) > stream->cycle_ms * 9u / 8u ||
           trial.abused.resets > most(trial.truth.resets, resets);
}

// Returns false where the stream has no frame for it at this time.
static bool choose(abuse_t *abuse, const copy_t *base, const stream_t *stream, kind_t kind,
                   uint32_t now_ms) {
    const uint32_t next = base->next;
    *abuse = (abuse_t){.at_ms = now_ms, .from_ms = now_ms, .held = CYCLES};
    if (next == 0u || next + 2u >= stream->count) {
        return false;
    }
    const uint8_t last =
        e2e_alive(&quiesce_can_messages[messages[stream->sender]].e2e, &stream->frame[next - 1u]);
    uint32_t which = next;
    switch (kind) {
    case REPEATED:
        which = next - 1u - random_below(next);
        break;
    case INSERTED: // half of them by somebody who knows the counter
        abuse->says = (1 << 14) + (int32_t)random_below(1u << 14); // nobody else's
        abuse->frame = make(
            stream->sender, abuse->says, true,
            (uint8_t)(last + (random_below(2) != 0u ? 1u + random_below(3) : random_below(16))));
        return true;
    case DELAYED:
        abuse->held = next;
        abuse->at_ms = stream->at_ms[next] + 1u + random_below(2u * stream->timeout_ms);
        break;
    case REORDERED:
    default:
        abuse->held = next;
        abuse->at_ms = stream->at_ms[next + 1u] + random_below(2);
        break;
    }
    abuse->says = stream->says[which];
    abuse->frame = stream->frame[which];
    return true;
}

static void name(const abuse_t *abuse, const stream_t *stream, kind_t kind, uint32_t seed) {
    fprintf(stderr, "effect: seed %" PRIu32 ", %s frame of id 0x%03X at %" PRIu32 " ms\n", seed,
            kind_names[kind], (unsigned)quiesce_can_messages[messages[stream->sender]].e2e.id,
            abuse->at_ms);
}

// Tries frames at random times of one stream.
static void abuse_stream(uint32_t seed, uint32_t frames, result_t *result) {
    static stream_t stream;
    static copy_t base;
    abuse_t abuse;
    random_state = seed * 2654435761u | 1u;
    base = (copy_t){.next = 0};
    can_receive_init(&base.receive, RATE_HZ);
    make_stream(&stream, random_below(SENDERS));
    const uint32_t end_ms = stream.at_ms[CYCLES - 1u];
    const uint32_t every = end_ms / ABUSES + 1u;
    for (uint32_t now_ms = 0; now_ms < end_ms && frames > 0u; now_ms++) {
        const kind_t kind = (kind_t)random_below(KINDS);
        if (random_below(every) == 0u && choose(&abuse, &base, &stream, kind, now_ms)) {
            result->abused[kind]++;
            frames--;
            if (has_effect(&base, &stream, &abuse, result) && result->with_effect++ < NAMED) {
                name(&abuse, &stream, kind, seed);
            }
        }
        step(&base, &stream, now_ms, CYCLES, NULL);
    }
}

static uint32_t sum(const result_t *result) {
    uint32_t frames = 0;
    for (uint32_t i = 0; i < KINDS; i++) {
        frames += result->abused[i];
    }
    return frames;
}

static bool read_number(const char *text, uint32_t *number) {
    char *end = NULL;
    const unsigned long long parsed = strtoull(text, &end, 10); // beyond its range: its largest
    *number = (uint32_t)parsed;
    return end != text && *end == '\0' && *text != '-' && parsed > 0 && parsed <= 1000000000u;
}

int main(int argc, char **argv) {
    uint32_t frames = 0;
    uint32_t first = DEFAULT_SEED;
    if (argc < 2 || argc > 3 || !read_number(argv[1], &frames) ||
        (argc == 3 && !read_number(argv[2], &first))) {
        fprintf(stderr, "frame_abuse: FRAMES [SEED], numbers from 1 to 1000000000\n");
        return 2;
    }
    result_t result = {{0}, 0, 0};
    uint32_t seed = first;
    for (; sum(&result) < frames; seed++) {
        abuse_stream(seed, frames - sum(&result), &result);
    }
    printf("{\"frames_abused\": %" PRIu32 ", \"frames_with_effect\": %" PRIu32
           ", \"frames_that_stopped\": %" PRIu32 ", \"first_seed\": %" PRIu32
           ", \"last_seed\": %" PRIu32,
           sum(&result), result.with_effect, result.stopped, first, seed - 1u);
    for (uint32_t i = 0; i < KINDS; i++) {
        printf(", \"%s\": %" PRIu32, kind_names[i], result.abused[i]);
    }
    printf("}\n");
    return result.with_effect == 0u ? 0 : 1;
}
