/// Whether a frame of a cyclic, protected message counts: its counter and its arrival time both
/// have to fit the message's cycle.
///
/// A sender that is unknown is on trial: FRESHNESS_TRIAL frames that follow each other in their
/// counter, each near its time and half a cycle or more after the one before. From the last of them
/// on the sender is known. A known sender's frame counts if it comes at the time that its counter's
/// steps give, a step a cycle, as much early or late as the tolerance says. What does not fit is
/// refused and changes nothing, so that a single frame that somebody inserts does not disturb a
/// sender that is well. Two different frames of one counter are two senders: none of them is known
/// from then on.
///
/// What a frame says holds for the timeout from the time that it was due, not from its arrival: a
/// late one holds no longer. After a gap it holds only until the next one is late, so that no
/// single frame holds anything for more than a cycle longer. Then the sender is unknown again.
///
/// The time at which frames are due follows their arrival by an eighth of a cycle a frame: clocks
/// differ, and senders on a PC sleep too long. Times are whole microseconds in 32 bits and
/// saturate; a frame's arrival is the last call of freshness_pass, so that it is known to a tick.
#ifndef FRESHNESS_H
#define FRESHNESS_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Frames of an unknown sender until it is known, the last of which counts.
#define FRESHNESS_TRIAL 3u

/// Tolerance of fast messages: what a bus under load, a USB adapter and Linux add.
#define FRESHNESS_JITTER_US 4000

typedef enum {
    FRESHNESS_COUNTS = 0,
    FRESHNESS_ON_TRIAL = 1, ///< follows its predecessor, of a sender that is not known yet
    FRESHNESS_BEGINS = 2,   ///< the first frame of an unknown sender
    FRESHNESS_REFUSED = 3,  ///< counter or time do not fit; history before it means nothing where
                            ///< the sender is not known (freshness_is_known)
} freshness_verdict_t;

typedef struct {
    int32_t cycle_us;
    int32_t timeout_us;
    int32_t
        tolerance_us; ///< early or late: three quarters of a cycle, FRESHNESS_JITTER_US at least
    int32_t drift_us; ///< of the due time with a frame
    int32_t since_due_us; ///< since the last frame of the row was due; below 0: it came early
    int32_t left_us;      ///< that what a known sender said last holds
    int32_t spaced_us;    ///< on trial: since the last frame that was on time
    uint32_t content;     ///< of the last frame of the row: tells a repetition from another frame
    uint8_t trial;        ///< frames on time; FRESHNESS_TRIAL: known; 0: nothing has been heard
    uint8_t alive;        ///< of the last frame of the row
    bool has_jumped;      ///< of a known sender, the last frame that came: it was ahead of its time
} freshness_t;

/// Other times, as at another tick rate; a known sender stays known. All zero before the first
/// call. cycle_us: 1 .. 10,000,000; timeout_us: below 15 cycles less tolerance and drift, so that a
/// counter that goes back never fits.
void freshness_use(freshness_t *self, int32_t cycle_us, int32_t timeout_us);

/// Judges a frame with a right CRC by its counter (0 .. 15). content: all of what it says, or a
/// hash that somebody who inserts frames cannot meet.
freshness_verdict_t freshness_judge(freshness_t *self, uint8_t alive, uint32_t content);

/// Time passes; 0 .. INT32_MAX microseconds.
void freshness_pass(freshness_t *self, int32_t passed_us);

/// Whether a sender is known, and what it said last holds.
bool freshness_is_known(const freshness_t *self);

#ifdef __cplusplus
}
#endif

#endif
