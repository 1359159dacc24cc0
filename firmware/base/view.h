/// What is known of the structure in a tick: one picture in fixed units, written in place by the
/// sensing half, read in place by laws and trackers.
///
/// Every quantity has a bit of validity: measured or computed from what is, fresh enough, plausible
/// and not saturated. What is not valid keeps a value in its range that nothing may rely on.
/// Magnitudes are below 2^30 in every unit.
#ifndef VIEW_H
#define VIEW_H

#include "harmonics.h"
#include "quiesce_size.h"
#include "quiesce_valid.h"

#define VIEW_LIMIT ((1 << 30) - 1)

/// Bits of validity, and of what a law needs: of a quantity for one body or damper its first bit
/// shifted by the number of the body or damper.
#define VIEW_ACCEL (UINT64_C(1) << QUIESCE_VALID_ACCEL)
#define VIEW_VELOCITY (UINT64_C(1) << QUIESCE_VALID_VELOCITY)
#define VIEW_DISPLACEMENT (UINT64_C(1) << QUIESCE_VALID_DISPLACEMENT)
#define VIEW_SUPPLY (UINT64_C(1) << QUIESCE_VALID_SUPPLY)
#define VIEW_RMS (UINT64_C(1) << QUIESCE_VALID_RMS)
#define VIEW_TONE (UINT64_C(1) << QUIESCE_VALID_TONE)
#define VIEW_LOCK (UINT64_C(1) << QUIESCE_VALID_LOCK)
#define VIEW_STROKE (UINT64_C(1) << QUIESCE_VALID_STROKE)
#define VIEW_STROKE_VELOCITY (UINT64_C(1) << QUIESCE_VALID_STROKE_VELOCITY)
#define VIEW_FORCE (UINT64_C(1) << QUIESCE_VALID_FORCE)
#define VIEW_CURRENT (UINT64_C(1) << QUIESCE_VALID_CURRENT)
#define VIEW_VOLTAGE (UINT64_C(1) << QUIESCE_VALID_VOLTAGE)
#define VIEW_TEMPERATURE (UINT64_C(1) << QUIESCE_VALID_TEMPERATURE)
/// The same quantity of every body or damper that the board has.
#define VIEW_EACH(quantity) ((quantity)*UINT64_C(15))

/// Absolute, positive in the structure's direction.
typedef struct {
    int32_t accel_um_s2;     ///< without its constant part
    int32_t velocity_um_s;   ///< rounded away from 0: its sign is that of the finer state
    int32_t displacement_nm; ///< from its resting place
} view_body_t;

/// Of a damper between its ends a and b.
typedef struct {
    int32_t stroke_nm;     ///< a - b
    int32_t velocity_um_s; ///< of the stroke
    int32_t force_mN;      ///< > 0 resists a stroke that grows
    int32_t current_mA;    ///< in the coil: measured, else as the command and the coil's lag say
    int32_t voltage_mV;    ///< across the coil
    int32_t temperature_mdegC;
} view_damper_t;

/// Of the sensor that is tracked.
typedef struct {
    uint32_t body; ///< that it is on
    int32_t rms_um_s2;
    int32_t freq_uHz;            ///< last dominant frequency
    bool is_narrow;              ///< without a lock: a narrow band in narrow_low .. narrow_high
    uint32_t phase_turn;         ///< of the lock: acceleration = amp x cos(phase), of the structure
                                 ///< when this tick's command reaches its driver
    uint32_t step_turn;          ///< a tick
    const harmonic_sums_t *half; ///< half a cycle whose sums became known in this tick, else NULL
} view_tone_t;

typedef struct {
    uint64_t valid;
    view_body_t body[QUIESCE_BODIES];
    view_damper_t damper[QUIESCE_DAMPERS];
    view_tone_t tone;
    int32_t supply_mV;
    bool is_output_on; ///< in the last tick: what was requested passed the guard
    bool may_learn;    ///< learning is not frozen
    bool is_at_rest;   ///< it has hardly vibrated for long (rest.h)
} view_t;

#endif
