/// Sizes of the build, and what it holds: how many sensors, bodies and dampers it can serve; a
/// board may have fewer. They are the same for everything that is linked together. With one of each
/// the loops vanish.
#ifndef QUIESCE_SIZE_H
#define QUIESCE_SIZE_H

#ifndef QUIESCE_SENSORS
#define QUIESCE_SENSORS 1 ///< 1 .. 8
#endif
#ifndef QUIESCE_BODIES
#define QUIESCE_BODIES 1 ///< 1 .. 4; the ground is not one of them
#endif
#ifndef QUIESCE_DAMPERS
#define QUIESCE_DAMPERS 1 ///< 1 .. 4
#endif

// The estimators that it holds, values of parameter estimator; one at least.
#ifndef QUIESCE_WITH_FIT
#define QUIESCE_WITH_FIT 1
#endif
#ifndef QUIESCE_WITH_FFT
#define QUIESCE_WITH_FFT 1
#endif

#define QUIESCE_MAX_SENSORS 8
#define QUIESCE_MAX_BODIES 4
#define QUIESCE_MAX_DAMPERS 4

#if QUIESCE_SENSORS < 1 || QUIESCE_SENSORS > QUIESCE_MAX_SENSORS
#error "QUIESCE_SENSORS is 1 .. 8"
#endif
#if QUIESCE_BODIES < 1 || QUIESCE_BODIES > QUIESCE_MAX_BODIES
#error "QUIESCE_BODIES is 1 .. 4"
#endif
#if QUIESCE_DAMPERS < 1 || QUIESCE_DAMPERS > QUIESCE_MAX_DAMPERS
#error "QUIESCE_DAMPERS is 1 .. 4"
#endif

#if !QUIESCE_WITH_FIT && !QUIESCE_WITH_FFT
#error "the build holds no estimator"
#endif

#endif
