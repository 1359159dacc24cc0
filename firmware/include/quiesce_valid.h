/// Bits of quiesce_picture_t.valid, 0 .. 31 in its first word: of a quantity for one body or damper
/// its first bit plus the number of the body or damper.
#ifndef QUIESCE_VALID_H
#define QUIESCE_VALID_H

enum {
    QUIESCE_VALID_ACCEL = 0,
    QUIESCE_VALID_VELOCITY = 4,
    QUIESCE_VALID_DISPLACEMENT = 8,
    QUIESCE_VALID_SUPPLY = 12,
    QUIESCE_VALID_RMS = 13,  ///< of the sensor that is tracked
    QUIESCE_VALID_TONE = 14, ///< its dominant component is known, or was a moment ago
    QUIESCE_VALID_LOCK = 15, ///< and is locked on to
    QUIESCE_VALID_STROKE = 16,
    QUIESCE_VALID_STROKE_VELOCITY = 20,
    QUIESCE_VALID_FORCE = 24,
    QUIESCE_VALID_CURRENT = 28,
    QUIESCE_VALID_VOLTAGE = 32,
    QUIESCE_VALID_TEMPERATURE = 36,
};

#endif
