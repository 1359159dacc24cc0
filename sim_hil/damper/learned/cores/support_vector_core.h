/* Support-vector regression with a Gaussian kernel (support_vector.h). */
#ifndef QUIESCE_SUPPORT_VECTOR_CORE_H
#define QUIESCE_SUPPORT_VECTOR_CORE_H

#include <math.h>

struct quiesce_support_vector {
    int inputs;
    int vectors;
    double force_scale_N;
    double gamma;
    double intercept;
    const double *coefficients;    /* vectors */
    const double *support_vectors; /* a row of inputs each */
};

/* u: inputs, scaled. */
static inline double quiesce_support_vector_N(const struct quiesce_support_vector *m,
                                              const double *u) {
    double sum = m->intercept;
    for (int j = 0; j < m->vectors; ++j) {
        const double *vector = m->support_vectors + j * m->inputs;
        double distance2 = 0.0;
        for (int k = 0; k < m->inputs; ++k) {
            distance2 += (u[k] - vector[k]) * (u[k] - vector[k]);
        }
        sum += m->coefficients[j] * exp(-m->gamma * distance2);
    }
    return m->force_scale_N * sum;
}

#endif
