/// All sensors of a board, each tick: their samples conditioned, velocity and displacement from
/// accelerations, strokes from bodies, everything with its bit of validity in the view.
///
/// What is measured takes the place of what would be computed. With one sensor, body and damper in
/// the build all loops vanish.
#ifndef SENSING_H
#define SENSING_H

#include "condition.h"
#include "motion.h"
#include "position.h"
#include "quiesce.h"
#include "quiesce_board.h"
#include "view.h"

/// A sensor; motion and position of an accelerometer only.
typedef struct {
    condition_t condition;
    condition_out_t sample; ///< of this tick
    motion_t motion;
    position_t position;
} channel_t;

/// Where a sensor measures what; between which bodies a damper is.
typedef struct {
    uint8_t sense;   ///< quiesce_sense_t
    uint8_t at;      ///< body or damper
    uint16_t offset; ///< in view_t, of what it measures; likewise its bit. No accelerometer's.
    uint64_t bit;
} sensor_place_t;

typedef struct {
    uint8_t end_a;
    uint8_t end_b; ///< or QUIESCE_GROUND
} damper_place_t;

typedef struct {
    sensor_place_t sensor[QUIESCE_SENSORS];
    damper_place_t damper[QUIESCE_DAMPERS];
    /// Sensors that are no accelerometers: those of bodies, then all others.
    uint8_t measured[QUIESCE_SENSORS];
    uint8_t of_bodies; ///< of these: those of bodies end here
    uint8_t of_all;    ///< and all end here
    uint8_t sensors;   ///< in use
    uint8_t bodies;
    uint8_t dampers;
} places_t;

typedef struct {
    places_t places;
    bool has_displacements; ///< are computed in each tick
    bool has_strokes;       ///< likewise; else where they are asked for
    channel_t channel[QUIESCE_SENSORS];
} sensing_t;

/// Of a board that has been checked.
void places_init(places_t *self, const quiesce_board_t *board);

/// What sensors there can provide: the bits that can ever be valid, those of tone, RMS, lock and
/// currents included.
uint64_t places_provide(const places_t *self);

/// Starts from rest. Board and parameters have been checked. needs: VIEW_ bits of the law; strokes
/// are computed only where there is one among these, displacements there and where the board has
/// several bodies.
void sensing_init(sensing_t *self, const quiesce_board_t *board, const quiesce_params_t *params,
                  uint64_t needs);

/// One tick: writes bodies, dampers but for their currents, supply, and all their bits.
void sensing_step(sensing_t *self, const quiesce_sample_t samples[QUIESCE_SENSORS], view_t *view);

/// Strokes of the last step where it has not computed them, and could.
void sensing_show_strokes(const sensing_t *self, view_t *view);

#endif
