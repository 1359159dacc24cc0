#include "ts_fuzzy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quiesce {

namespace {

double exponent(const FuzzyCluster &cluster, const Inputs &u) {
    double sum = 0.0;
    for (std::size_t k = 0; k < cluster.centre.size(); ++k) {
        const double distance = (u[k] - cluster.centre[k]) / cluster.width[k];
        sum -= 0.5 * distance * distance;
    }
    return sum;
}

double conclusion_N(const FuzzyCluster &cluster, const Inputs &u) {
    double force_N = cluster.offset_N;
    for (std::size_t k = 0; k < cluster.gain_N.size(); ++k) {
        force_N += cluster.gain_N[k] * u[k];
    }
    return force_N;
}

} // namespace

double TsFuzzy::force_N(const DamperInput &input, const double * /*state*/,
                        double * /*rates*/) const {
    const Inputs u = box().scaled(input);
    // Relative to the nearest cluster: the sum never vanishes.
    double reference = -std::numeric_limits<double>::infinity();
    for (const FuzzyCluster &cluster : clusters_) {
        reference = std::max(reference, exponent(cluster, u));
    }
    double sum = 0.0;
    double moment = 0.0;
    for (const FuzzyCluster &cluster : clusters_) {
        const double weight = std::exp(exponent(cluster, u) - reference);
        sum += weight;
        moment += weight * conclusion_N(cluster, u);
    }
    return moment / sum;
}

} // namespace quiesce
