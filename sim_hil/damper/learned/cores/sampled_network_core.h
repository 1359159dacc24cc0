/* A network over delayed copies of what the damper sees and, where it is recurrent, over its own
 * earlier forces (sampled_network.h); with a quadrature, over that, too. */
#ifndef QUIESCE_SAMPLED_NETWORK_CORE_H
#define QUIESCE_SAMPLED_NETWORK_CORE_H

#include <math.h>
#include <string.h>

#include "input_box_core.h"
#include "network_core.h"

/* State: time since the last sample, whether there was one, the force held, the two means of the
 * quadrature, then the moments (latest first, `width` each), then the earlier forces. */
enum {
    quiesce_sampled_clock,
    quiesce_sampled_started,
    quiesce_sampled_held,
    quiesce_sampled_means,
    quiesce_quadrature_states = 2,
    quiesce_quadrature_features = 4
};

/* Envelope, instantaneous frequency and phase of a displacement, from its past only.
 *
 * The published features are those of the analytic signal x + j H[x], whose Hilbert transform H
 * needs the whole record, the future included. In place of H[x] stands what it is for a swing of
 * one frequency, -v / w, with w from running means over a window:
 *
 *   w = sqrt(mean(v^2) / mean(x^2)),  d = sqrt(x^2 + (v/w)^2),  x = d cos p,  -v/w = d sin p
 *
 * Both means start at 0 and share their window, so that their ratio holds from the first sample.
 * The phase is a pair, cos p and sin p: p itself jumps. Source: review of MR damper models, eq 34.
 * All > 0; w is cut off at lowest_rad_s and at highest_rad_s, which is more. */
struct quiesce_quadrature {
    double window_s;
    double envelope_m; /* below a thousandth of it is rest, which has neither frequency nor phase */
    double lowest_rad_s;
    double highest_rad_s;
};

struct quiesce_sampled {
    double sample_time_s;
    double force_scale_N;
    int inputs; /* of the box */
    const double *low;
    const double *high;
    const int *lags; /* of the inputs, in samples, rising from >= 0 */
    int lag_count;
    const int *feedback; /* of the force, rising from >= 1 */
    int feedback_count;
    const struct quiesce_quadrature *quadrature; /* or NULL */
    const struct quiesce_layer *layers;
    int layer_count;
    int widest;
};

static inline int quiesce_sampled_width(const struct quiesce_sampled *m) {
    return m->inputs + (m->quadrature ? quiesce_quadrature_features : 0);
}

static inline int quiesce_sampled_first_moment(const struct quiesce_sampled *m) {
    return quiesce_sampled_means + (m->quadrature ? quiesce_quadrature_states : 0);
}

static inline int quiesce_sampled_moments(const struct quiesce_sampled *m) {
    return m->lags[m->lag_count - 1] + 1;
}

static inline int quiesce_sampled_forces(const struct quiesce_sampled *m) {
    return m->feedback_count > 0 ? m->feedback[m->feedback_count - 1] : 0;
}

static inline int quiesce_sampled_states(const struct quiesce_sampled *m) {
    return quiesce_sampled_first_moment(m) + quiesce_sampled_moments(m) * quiesce_sampled_width(m) +
           quiesce_sampled_forces(m);
}

/* Inputs of the network. */
static inline int quiesce_sampled_taken(const struct quiesce_sampled *m) {
    return m->lag_count * quiesce_sampled_width(m) + m->feedback_count;
}

/* Takes a sample into the means. */
static inline void quiesce_quadrature_update(const struct quiesce_quadrature *q, double x_m,
                                             double v_m_s, double dt_s, double *means) {
    const double part = dt_s / (q->window_s + dt_s);
    means[0] += part * (x_m * x_m - means[0]);
    means[1] += part * (v_m_s * v_m_s - means[1]);
}

/* Envelope and frequency, scaled, cosine and sine of the phase; all 0 at rest. */
static inline void quiesce_quadrature_write(const struct quiesce_quadrature *q, double x_m,
                                            double v_m_s, const double *means, double *out) {
    const double rest_m = 1e-3 * q->envelope_m;
    const double raw_rad_s = sqrt(means[1] / quiesce_larger(means[0], rest_m * rest_m));
    const double w_rad_s = quiesce_clamped(raw_rad_s, q->lowest_rad_s, q->highest_rad_s);
    const double turned_m = -v_m_s / w_rad_s;
    const double envelope_m = hypot(x_m, turned_m);
    const double least = q->lowest_rad_s;
    out[0] = out[1] = out[2] = out[3] = 0.0;
    if (!(envelope_m < rest_m)) {
        out[0] =
            2.0 * (quiesce_clamped(envelope_m, 0.0, q->envelope_m) - 0.0) / (q->envelope_m - 0.0) -
            1.0;
        out[1] = 2.0 * (w_rad_s - least) / (q->highest_rad_s - least) - 1.0;
        out[2] = x_m / envelope_m;
        out[3] = turned_m / envelope_m;
    }
}

/* From the delayed values in the state. room: quiesce_sampled_taken values, then twice the widest
 * layer. */
static inline double quiesce_sampled_N(const struct quiesce_sampled *m, const double *state,
                                       double *room) {
    const int width = quiesce_sampled_width(m);
    const double *moments = state + quiesce_sampled_first_moment(m);
    const double *forces = moments + quiesce_sampled_moments(m) * width;
    double *in = room;
    for (int j = 0; j < m->lag_count; ++j) {
        const double *moment = moments + m->lags[j] * width;
        for (int k = 0; k < width; ++k) {
            *in++ = k < m->inputs ? quiesce_scaled(moment[k], m->low[k], m->high[k]) : moment[k];
        }
    }
    for (int j = 0; j < m->feedback_count; ++j) {
        *in++ = forces[m->feedback[j] - 1] / m->force_scale_N;
    }
    double out = 0.0;
    quiesce_network_run(m->layers, m->layer_count, room, &out, in, m->widest);
    return m->force_scale_N * out;
}

/* picked: the inputs of the box, as they are. */
static inline void quiesce_sampled_take(const struct quiesce_sampled *m, const double *picked,
                                        double x_m, double v_m_s, double *state, double *room) {
    const int width = quiesce_sampled_width(m);
    const int count = quiesce_sampled_moments(m);
    double *moments = state + quiesce_sampled_first_moment(m);
    memmove(moments + width, moments, (size_t)((count - 1) * width) * sizeof *moments);
    memcpy(moments, picked, (size_t)m->inputs * sizeof *moments);
    if (m->quadrature) {
        double *means = state + quiesce_sampled_means;
        quiesce_quadrature_update(m->quadrature, x_m, v_m_s, m->sample_time_s, means);
        quiesce_quadrature_write(m->quadrature, x_m, v_m_s, means, moments + m->inputs);
    }
    const double force_N = quiesce_sampled_N(m, state, room);
    const int earlier = quiesce_sampled_forces(m);
    if (earlier > 0) {
        double *forces = moments + count * width;
        memmove(forces + 1, forces, (size_t)(earlier - 1) * sizeof *forces);
        forces[0] = force_N;
    }
    state[quiesce_sampled_held] = force_N;
    state[quiesce_sampled_started] = 1.0;
}

/* After a step of dt_s: is a sample due? It is when its time has come to all but a millionth of
 * it, for times are sums of steps. */
static inline int quiesce_sampled_is_due(double sample_time_s, double dt_s, double *state) {
    const double due_s = (1.0 - 1e-6) * sample_time_s;
    state[quiesce_sampled_clock] += dt_s;
    if (!(state[quiesce_sampled_clock] >= due_s)) {
        return 0;
    }
    state[quiesce_sampled_clock] -= sample_time_s;
    if (state[quiesce_sampled_clock] >= due_s) {
        state[quiesce_sampled_clock] = 0.0; /* steps longer than the sample time */
    }
    return 1;
}

#endif
