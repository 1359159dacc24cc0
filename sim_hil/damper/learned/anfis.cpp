#include "anfis.h"

#include <array>
#include <cmath>

namespace quiesce {

Anfis::Anfis(InputBox box, double stroke_m, std::vector<GaussianSet> sets,
             std::vector<double> consequents_N)
    : StaticDamper(std::move(box), stroke_m), sets_(std::move(sets)),
      consequents_N_(std::move(consequents_N)) {}

namespace {

double exponent(const GaussianSet &set, std::size_t k, double value) {
    const double distance = (value - set.centres[k]) / set.widths[k];
    return -0.5 * distance * distance;
}

/// Exponent of the nearest membership: the weights are taken relative to it, so that their sum does
/// not vanish however narrow they are.
double nearest(const GaussianSet &set, double value) {
    double most = exponent(set, 0, value);
    for (std::size_t k = 1; k < set.centres.size(); ++k) {
        most = std::max(most, exponent(set, k, value));
    }
    return most;
}

} // namespace

double Anfis::force_N(const DamperInput &input, const double * /*state*/,
                      double * /*rates*/) const {
    const Inputs u = box().clamped(input);
    // Rules of the inputs so far: their weights, and where the next input's are appended.
    std::vector<double> weights{1.0};
    for (std::size_t k = 0; k < sets_.size(); ++k) {
        const double reference = nearest(sets_[k], u[k]);
        std::vector<double> grades;
        for (std::size_t j = 0; j < sets_[k].centres.size(); ++j) {
            grades.push_back(std::exp(exponent(sets_[k], j, u[k]) - reference));
        }
        std::vector<double> next;
        for (const double weight : weights) {
            for (const double grade : grades) {
                next.push_back(weight * grade);
            }
        }
        weights.swap(next);
    }
    double sum = 0.0;
    double moment = 0.0;
    for (std::size_t r = 0; r < weights.size(); ++r) {
        sum += weights[r];
        moment += weights[r] * consequents_N_[r];
    }
    return moment / sum;
}

} // namespace quiesce
