/* ANFIS (anfis.h): Gaussian memberships on a grid of rules. */
#ifndef QUIESCE_ANFIS_CORE_H
#define QUIESCE_ANFIS_CORE_H

#include <math.h>

#include "input_box_core.h"

struct quiesce_anfis {
    int inputs;
    const int *counts;           /* memberships of each input */
    int rules;                   /* product of the counts */
    const double *centres;       /* of all inputs, one after the other */
    const double *widths;        /* likewise, > 0 */
    const double *consequents_N; /* the last input's membership varies fastest */
};

static inline double quiesce_anfis_exponent(const struct quiesce_anfis *m, int place,
                                            double value) {
    const double distance = (value - m->centres[place]) / m->widths[place];
    return -0.5 * distance * distance;
}

/* u: inputs, cut off at their ranges; grades: room for one a membership. Memberships are taken
 * relative to the nearest one, so that their sum does not vanish however narrow they are. */
static inline double quiesce_anfis_N(const struct quiesce_anfis *m, const double *u,
                                     double *grades) {
    int first = 0;
    for (int k = 0; k < m->inputs; ++k) {
        double nearest = quiesce_anfis_exponent(m, first, u[k]);
        for (int j = 1; j < m->counts[k]; ++j) {
            nearest = quiesce_larger(nearest, quiesce_anfis_exponent(m, first + j, u[k]));
        }
        for (int j = 0; j < m->counts[k]; ++j) {
            grades[first + j] = exp(quiesce_anfis_exponent(m, first + j, u[k]) - nearest);
        }
        first += m->counts[k];
    }
    double sum = 0.0;
    double moment = 0.0;
    for (int rule = 0; rule < m->rules; ++rule) {
        double weight = 1.0;
        int stride = m->rules;
        const double *grade = grades;
        for (int k = 0; k < m->inputs; ++k) {
            stride /= m->counts[k];
            weight *= grade[rule / stride % m->counts[k]];
            grade += m->counts[k];
        }
        sum += weight;
        moment += weight * m->consequents_N[rule];
    }
    return moment / sum;
}

#endif
