/// Small networks in integers: from signals to a current, through one or two layers.
///
/// Words of a network: a number of whoever uses it, largest current in mA, inputs m, delay in
/// ticks, ticks a second that the delay counts in (0 without one), layers l; m inputs
/// (network_input_t); l layers; the output. A table is sections (sections.h), each a network.
///
/// A layer of n units over k values: kind, n, then n units. A dense unit {shift, bias, k weights}
/// is tanh, or the straight line limited to -1 .. 1, of (bias + sum of weights x values) x
/// 2^-shift. A radial unit {k centres, k sharpnesses} is exp(-sum of ((value - centre) x
/// sharpness)^2), a Gaussian of width 1 / (sharpness sqrt 2). Of a normalised layer each is divided
/// by the sum of all; the nearest one counts as 1 before that, so that there always is a sum.
///
/// The output of the last layer's n units: order, shift, bias, then n coefficients (order 0), or n
/// times a coefficient and k more for the values that the layer sees (order 1: rules with
/// conclusions of first order). The current is (bias + sum of unit x coefficient) x 2^-shift mA,
/// or, with order 1, that of unit x (coefficient + sum of k coefficients x values), to the nearest
/// mA, limited to 0 .. largest.
///
/// Values are Q24 within -1 .. 1: an input is limited to low .. high and scaled to that, and what
/// units give lies within it by their nature. With a delay each input is there twice, as it is and
/// as it was so many ticks ago (0 before that). Weights, biases, coefficients are below 2^24 in
/// magnitude, in units of 2^-shift; centres Q24 within -4 .. 4; sharpnesses Q16, 0 to below 256.
/// Products are below 2^48, of the output's first order below 2^53; sums of 33 below 2^58.
/// Arguments of tanh are limited to +-32, of one Gaussian's side to +-128, of all of them to 128:
/// there is nothing left of either. exp and tanh are within 2^-23 (activation.h).
///
/// About 8 instructions a weight or coefficient, 30 a centre, 90 to 140 a unit; a table's sum is
/// bounded. On a Cortex-M4 12 and 8 tanh units on 6 values take 4480, 21 Gaussians on 4 4690.
#ifndef NETWORK_H
#define NETWORK_H

#include "sections.h"

#define NETWORK_MOST_INPUTS 8u
#define NETWORK_MOST_UNITS 32u ///< of a layer
#define NETWORK_MOST_LAYERS 2u
#define NETWORK_MOST_DELAY 8u
#define NETWORK_PAST 12u        ///< inputs x ticks of delay
#define NETWORK_MOST_WORK 5000u ///< instructions of a table's networks, about

typedef struct {
    uint32_t signal; ///< of whoever reads it
    int32_t low;     ///< in the signal's unit
    int32_t high;    ///< above low
    int32_t factor;  ///< > 0; (high - low) x factor x 2^-shift is at most 2, Q24
    uint32_t shift;
} network_input_t;

typedef struct {
    uint32_t own; ///< of whoever uses it
    uint32_t largest_mA;
    uint32_t inputs;
    uint32_t delay_ticks; ///< 0: no delayed inputs
    int32_t rate_Hz;      ///< of these ticks, > 0; 0 iff there are none
    uint32_t layers;
    network_input_t input[];
} network_t;

/// Zeros: from rest.
typedef struct {
    int32_t x_q24[NETWORK_PAST];
    uint32_t at;
} network_past_t;

/// A network as its words say.
static inline const network_t *network_of(const uint32_t *words) {
    return (const network_t *)(const void *)words;
}

/// How many of so many words are a network. Returns 0 iff they hold none: a number of inputs,
/// layers, units or ticks out of its range, or fewer words than those need.
uint32_t network_size(const uint32_t *words, uint32_t count);

/// Whether all numbers of a network with a size are as this header says; its signals are whoever's
/// who reads them.
bool network_is_good(const network_t *self);

/// As sections_check, of a kind with network_size; then SHAPE where all of them together would take
/// more than NETWORK_MOST_WORK instructions.
quiesce_table_verdict_t network_table_check(const sections_kind_t *kind, const uint32_t *words);

/// Ticks a second that a checked table's delays count in: TABLE_ANY_RATE where it has none, 0 where
/// they differ.
uint32_t network_table_rate_Hz(const uint32_t *words);

/// The network after this one, which has been checked.
const network_t *network_next(const network_t *self);

/// The current, mA, for values of the inputs, any. A tick on for what is delayed.
int32_t network_current_mA(const network_t *self, network_past_t *past, const int32_t *values);

#endif
