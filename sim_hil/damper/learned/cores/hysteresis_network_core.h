/* Networks over the states of simple hysteresis elements (hysteresis_network.h has the equations).
 */
#ifndef QUIESCE_HYSTERESIS_NETWORK_CORE_H
#define QUIESCE_HYSTERESIS_NETWORK_CORE_H

#include <math.h>

#include "input_box_core.h"
#include "network_core.h"

struct quiesce_hysteresis {
    double force_scale_N;
    double current_scale_A;
    double field_exponent;
    double saturation;
    double clip;
    int uses_accel;
    int has_base;
    int coils;
    const double *coil_times_s;
    const double *coil_fall_times_s;
    int elastics;
    const double *elastic_times_s;
    int chain;
    const double *chain_times_s;
    int stops;
    const double *stop_reaches_m;
    const double *means;
    const double *scales;
    const double *skip; /* a row of features for each head */
    int features;
    int heads;
    const struct quiesce_layer *const *members;
    const int *layer_counts;
    int member_count;
    int widest;
};

static inline int quiesce_hysteresis_states(const struct quiesce_hysteresis *m) {
    return m->coils + m->elastics + m->chain + m->stops;
}

static inline void quiesce_hysteresis_rates(const struct quiesce_hysteresis *m, double v_m_s,
                                            double current_A, const double *state, double *rates) {
    for (int j = 0; j < m->coils; ++j) {
        const double rise_A = current_A - *state++;
        *rates++ = rise_A / (rise_A > 0.0 ? m->coil_times_s : m->coil_fall_times_s)[j];
    }
    for (int j = 0; j < m->elastics; ++j) {
        *rates++ = v_m_s - *state++ / m->elastic_times_s[j];
    }
    double from_m_s = v_m_s;
    for (int j = 0; j < m->chain; ++j) {
        *rates++ = (from_m_s - *state) / m->chain_times_s[j];
        from_m_s = *state++;
    }
    for (int j = 0; j < m->stops; ++j) {
        *rates++ = (v_m_s - fabs(v_m_s) * *state++) / m->stop_reaches_m[j];
    }
}

/* The current of the first coil, which the base sees. */
static inline double quiesce_hysteresis_current_A(const struct quiesce_hysteresis *m,
                                                  double current_A, const double *state) {
    return m->coils > 0 ? state[0] : current_A;
}

/* Of full current, 0 .. 1. */
static inline double quiesce_hysteresis_field(const struct quiesce_hysteresis *m,
                                              double current_A) {
    const double part = quiesce_larger(0.0, current_A / m->current_scale_A);
    const double toe = pow(part, m->field_exponent);
    return toe * (1.0 + m->saturation) / (m->saturation + toe);
}

/* motion: position in m, velocity in m/s, acceleration in m/s2. out: features of them all. */
static inline void quiesce_hysteresis_features(const struct quiesce_hysteresis *m,
                                               const double *motion, double base_N,
                                               const double *state, double *out) {
    const int own = quiesce_hysteresis_states(m);
    int count = 0;
    out[count++] = motion[0];
    out[count++] = motion[1];
    if (m->uses_accel) {
        out[count++] = motion[2];
    }
    for (int k = 0; k < own; ++k) {
        out[count++] = state[k];
    }
    if (m->has_base) {
        out[count++] = base_N;
    }
    for (int k = 0; k < count; ++k) {
        out[k] = quiesce_clamped((out[k] - m->means[k]) / m->scales[k], -m->clip, m->clip);
    }
}

/* What the networks add to the base. room: heads values twice, then twice the widest layer. */
static inline double quiesce_hysteresis_added_N(const struct quiesce_hysteresis *m,
                                                const double *features, double current_A,
                                                double *room) {
    double *heads = room;
    double *one = room + m->heads;
    for (int k = 0; k < m->heads; ++k) {
        heads[k] = 0.0;
    }
    for (int j = 0; j < m->member_count; ++j) {
        quiesce_network_run(m->members[j], m->layer_counts[j], features, one, one + m->heads,
                            m->widest);
        for (int k = 0; k < m->heads; ++k) {
            heads[k] += one[k] / m->member_count;
        }
    }
    const double g = quiesce_hysteresis_field(m, current_A);
    double power = 1.0;
    double sum = 0.0;
    for (int k = 0; k < m->heads; ++k) {
        double linear = heads[k];
        for (int j = 0; j < m->features; ++j) {
            linear += features[j] * m->skip[k * m->features + j];
        }
        sum += power * linear;
        power *= g;
    }
    return m->force_scale_N * sum;
}

#endif
