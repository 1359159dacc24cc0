/* What a learned model sees (input_box.h). The files of this folder are C11 and C++ alike: the
 * plant's classes run them, and an exported damper is made of them. */
#ifndef QUIESCE_INPUT_BOX_CORE_H
#define QUIESCE_INPUT_BOX_CORE_H

static inline double quiesce_clamped(double value, double low, double high) {
    return value < low ? low : high < value ? high : value;
}

static inline double quiesce_larger(double a, double b) {
    return a < b ? b : a;
}

/* Cut off at low and high, from -1 there to 1. */
static inline double quiesce_scaled(double value, double low, double high) {
    const double part = (quiesce_clamped(value, low, high) - low) / (high - low);
    return 2.0 * part - 1.0;
}

#endif
