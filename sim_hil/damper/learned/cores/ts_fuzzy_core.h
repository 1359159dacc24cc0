/* Takagi-Sugeno clusters with a linear force in each (ts_fuzzy.h). */
#ifndef QUIESCE_TS_FUZZY_CORE_H
#define QUIESCE_TS_FUZZY_CORE_H

#include <math.h>

#include "input_box_core.h"

struct quiesce_ts_fuzzy {
    int inputs;
    int clusters;
    const double *centres; /* a row of inputs each, scaled; so are the widths */
    const double *widths;
    const double *gains_N; /* force for one unit of the scaled input */
    const double *offsets_N;
};

static inline double quiesce_ts_exponent(const struct quiesce_ts_fuzzy *m, int cluster,
                                         const double *u) {
    double sum = 0.0;
    for (int k = 0; k < m->inputs; ++k) {
        const int place = cluster * m->inputs + k;
        const double distance = (u[k] - m->centres[place]) / m->widths[place];
        sum -= 0.5 * distance * distance;
    }
    return sum;
}

/* u: inputs, scaled. Weights are relative to the nearest cluster: their sum never vanishes. */
static inline double quiesce_ts_fuzzy_N(const struct quiesce_ts_fuzzy *m, const double *u) {
    double nearest = quiesce_ts_exponent(m, 0, u);
    for (int c = 1; c < m->clusters; ++c) {
        nearest = quiesce_larger(nearest, quiesce_ts_exponent(m, c, u));
    }
    double sum = 0.0;
    double moment = 0.0;
    for (int c = 0; c < m->clusters; ++c) {
        double force_N = m->offsets_N[c];
        for (int k = 0; k < m->inputs; ++k) {
            force_N += m->gains_N[c * m->inputs + k] * u[k];
        }
        const double weight = exp(quiesce_ts_exponent(m, c, u) - nearest);
        sum += weight;
        moment += weight * force_N;
    }
    return moment / sum;
}

#endif
