/// Adapts pulses to the plant by trying: change a pulse a little, wait until the vibration has
/// settled, measure, and keep what lowers the cost.
///
/// What counts is the reach, half peak-to-peak displacement times (2 pi f)^2, from the fundamental
/// and the third harmonic (the fundamental alone misleads: a sticking damper's optimum cuts the
/// peak, not the fundamental) over half cycles, and RMS acceleration beyond what is allowed
/// (adapt_cost.h).
///
/// A search begins, where acceleration is limited, with a trial without current, which tells the
/// limit. Then it has three parts. First the pulse without its gap: edges that are moved little by
/// little find the best pulse near the one that they start from, and on another plant a plain
/// constant current may be better than that. Then both edges at once (adapt_square.h). Last the
/// level. A pulse without its gap and a level are tried between two measurements of the pulse as it
/// was, and kept where they are better than both; a move of the edges is taken back where the pulse
/// then measures worse than before, and made again where it gains. A search ends when nothing is
/// left to gain, or has lasted so long that the rest is not worth it, but not while acceleration is
/// above its limit.
///
/// A measurement goes on until its last two parts agree: then the vibration has settled. What they
/// differ by is noise; the more of it, the longer the parts.
///
/// What is learnt is kept for each point of the pulse table; it is bounded by adapt_cfg_t, and can
/// be frozen, cleared, taken out and put back. A trial is given up, and nothing learnt, when the
/// lock is lost, a fault is present, the frequency has moved by 2 % once it is to be measured, or
/// two measurements of the same pulse differ by more than 2 %: then something else has changed.
///
/// Formats: edges in half turns Q16 (364 is one degree), level as a factor Q15; accelerations
/// um/s2. Bounded: some 35 instructions a tick, 300 at most at the end of a cycle, spread over
/// several ticks.
#ifndef ADAPT_H
#define ADAPT_H

#include "adapt_cost.h"
#include "adapt_square.h"

#define ADAPT_POINTS 64u

/// Change of the level by which the pulse has no current at all, not even between pulses.
#define ADAPT_NO_CURRENT INT16_MIN

/// What is changed.
enum { ADAPT_ON_EDGE, ADAPT_OFF_EDGE, ADAPT_LEVEL, ADAPT_WHOLE, ADAPT_COORDINATES };

/// Change of a pulse. Zero: none.
typedef struct {
    int16_t value[ADAPT_COORDINATES]; ///< edges: half turns Q16, later is positive; level: Q15,
                                      ///< <= 0; whole: 1 without any gap, else 0
} adapt_trim_t;

typedef struct {
    uint32_t start_ticks;   ///< that a vibration lasts before the first trial
    uint32_t settle_ticks;  ///< before a measurement
    uint32_t measure_ticks; ///< at most so long, and what completes cycles
    uint32_t rest_ticks;    ///< between trials once nothing is left to gain
    int16_t edge_limit_q16;
    int16_t level_limit_q15; ///< most that the level may be lowered
} adapt_cfg_t;

typedef enum {
    ADAPT_WAITING = 0,   ///< for a lock, or for the end of a fault
    ADAPT_MEASURING = 1, ///< how it is without a change
    ADAPT_TRYING = 2,    ///< a trial's change is in effect
    ADAPT_CHECKING = 3,  ///< back again: is it as it was?
    ADAPT_RESTING = 4,   ///< nothing left to gain
} adapt_state_t;

/// Parts of a search, in their order.
enum { ADAPT_TRY_WHOLE, ADAPT_TRY_EDGES, ADAPT_TRY_LEVEL, ADAPT_TRY_NOTHING };

/// Steps of the edges: small, after a gain large, then small again.
enum { ADAPT_FIRST, ADAPT_LARGE, ADAPT_LAST };

/// Both edges of a pulse.
typedef struct {
    int16_t on;
    int16_t off;
} adapt_edges_t;

typedef struct {
    adapt_cfg_t cfg;
    adapt_trim_t trim[ADAPT_POINTS]; ///< learnt
    uint32_t ticks;                  ///< left to settle or rest
    adapt_meter_t meter;
    adapt_effect_t before;   ///< without a trial's change
    adapt_effect_t trial;    ///< with it: whole pulse or level
    int32_t noise_q20;       ///< of a measurement, standard deviation
    adapt_square_t square;   ///< edges
    adapt_edges_t from[2];   ///< edges at both points before the last move
    int32_t doubt_q20;       ///< a gain of less is no reason to move again
    uint32_t left_ticks;     ///< of the search
    uint32_t free_rms_um_s2; ///< RMS acceleration without current; 0: not known
    adapt_goal_t goal;       ///< of this half cycle
    adapt_move_t move;       ///< the last one
    bool is_again;           ///< it repeats the one before
    bool is_free;            ///< the trial is one without current
    bool is_due;             ///< a measurement is complete, and judged in the next tick
    uint8_t free_failures;   ///< of such trials
    uint8_t longer_log2;     ///< parts of a measurement over the shortest ones
    uint8_t state;           ///< adapt_state_t
    uint8_t part;            ///< of the search
    uint8_t size;            ///< of the edges' steps
    uint8_t failures;        ///< of this part: directions, trials that were cut short
    uint8_t index;           ///< of the point below the frequency
    uint8_t nearest;         ///< of the point nearest to it
    uint8_t moved_index;     ///< the first of them, or UINT8_MAX: there was none
    int8_t direction;        ///< of the level, 1 or -1
    uint32_t freq_mHz;       ///< that the search is for
    uint32_t now_mHz;        ///< mean over some half cycles: each one's own is some 1 % off
    uint32_t trials;         ///< finished, saturating: a round of the edges is one
    uint32_t gains;          ///< of them that lowered the cost, saturating
} adapt_t;

/// Where a half cycle lies in the table, and what is wanted there.
typedef struct {
    uint32_t index;    ///< of the point below its frequency
    uint32_t part_q16; ///< of the way to the next point, 0 .. 65536
    adapt_goal_t goal;
} adapt_aim_t;

/// One tick's view of the vibration.
typedef struct {
    bool may_try; ///< locked, frequency known, no fault, not frozen
    uint32_t freq_mHz;
    const harmonic_sums_t *half; ///< of half a cycle that ended in this tick, else NULL
} adapt_in_t;

/// Nothing learnt.
void adapt_init(adapt_t *self, const adapt_cfg_t *cfg);

/// Forgets what was learnt, gives a trial up.
void adapt_clear(adapt_t *self);

/// Gives a trial up; what was learnt stays.
void adapt_pause(adapt_t *self, bool has_lost_lock);

/// A half cycle begins; before its first adapt_step.
void adapt_aim(adapt_t *self, const adapt_aim_t *aim);

/// One tick.
void adapt_step(adapt_t *self, const adapt_in_t *in);

/// What is learnt between points index and index + 1, part_q16 of the way (0 .. 65536), with the
/// trial's change where one is in effect.
adapt_trim_t adapt_trim_at(const adapt_t *self, uint32_t index, uint32_t part_q16);

/// Whether a trim lies within the limits.
bool adapt_is_allowed(const adapt_cfg_t *cfg, const adapt_trim_t *trim);

#endif
