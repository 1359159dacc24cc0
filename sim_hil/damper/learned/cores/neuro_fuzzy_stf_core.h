/* Self-tuning fuzzy model, frozen (neuro_fuzzy_stf.h). */
#ifndef QUIESCE_NEURO_FUZZY_STF_CORE_H
#define QUIESCE_NEURO_FUZZY_STF_CORE_H

#include <math.h>

#include "input_box_core.h"

enum { quiesce_stf_labels = 5, quiesce_stf_rules = 25 };

struct quiesce_triangles {
    double centres[quiesce_stf_labels]; /* rising */
    double bases[quiesce_stf_labels];   /* > 0 */
};

struct quiesce_stf {
    double force_scale_N;
    double disp_scale_m;       /* the displacement counts as a part of it, cut off at +-1 */
    double velocity_scale_m_s; /* likewise */
    double current_scale_A;    /* likewise, cut off at 0 and 1 */
    int uses_minimum;          /* of the memberships, else their product */
    struct quiesce_triangles disp;
    struct quiesce_triangles velocity;
    struct quiesce_triangles current;
    double outputs[quiesce_stf_labels]; /* of NB, NS, ZE, PS, PB */
    double gains[quiesce_stf_labels];   /* of the current's labels */
    int labels[quiesce_stf_rules];      /* rows displacement, columns velocity, NB to PB */
};

static inline double quiesce_stf_grade(const struct quiesce_triangles *set, int k, double value) {
    return quiesce_larger(0.0, 1.0 - 2.0 * fabs(value - set->centres[k]) / set->bases[k]);
}

/* Where no membership holds, the output fades to 0 instead of dividing by it. */
static inline double quiesce_stf_mean(double moment, double sum) {
    return moment / quiesce_larger(sum, 1e-6);
}

static inline double quiesce_stf_N(const struct quiesce_stf *m, double current_A, double x_m,
                                   double v_m_s) {
    const double part = quiesce_clamped(current_A / m->current_scale_A, 0.0, 1.0);
    double held = 0.0;
    double gained = 0.0;
    for (int k = 0; k < quiesce_stf_labels; ++k) {
        const double grade = quiesce_stf_grade(&m->current, k, part);
        held += grade;
        gained += grade * m->gains[k];
    }
    const double x = quiesce_clamped(x_m / m->disp_scale_m, -1.0, 1.0);
    const double v = quiesce_clamped(v_m_s / m->velocity_scale_m_s, -1.0, 1.0);
    double sum = 0.0;
    double moment = 0.0;
    for (int r = 0; r < quiesce_stf_rules; ++r) {
        const double a = quiesce_stf_grade(&m->disp, r / quiesce_stf_labels, x);
        const double b = quiesce_stf_grade(&m->velocity, r % quiesce_stf_labels, v);
        const double height = m->uses_minimum ? (b < a ? b : a) : a * b;
        sum += height;
        moment += height * m->outputs[m->labels[r]];
    }
    return quiesce_stf_mean(m->force_scale_N * quiesce_stf_mean(gained, held) * moment, sum);
}

#endif
