#include "anfis.h"

#include <utility>

#include "anfis_core.h"

namespace quiesce {

Anfis::Anfis(InputBox box, double stroke_m, const std::vector<GaussianSet> &sets,
             std::vector<double> consequents_N)
    : StaticDamper(std::move(box), stroke_m), consequents_N_(std::move(consequents_N)) {
    for (const GaussianSet &set : sets) {
        counts_.push_back(static_cast<int>(set.centres.size()));
        centres_.insert(centres_.end(), set.centres.begin(), set.centres.end());
        widths_.insert(widths_.end(), set.widths.begin(), set.widths.end());
    }
}

double Anfis::force_N(const DamperInput &input, const double * /*state*/,
                      double * /*rates*/) const {
    const Inputs u = box().clamped(input);
    const quiesce_anfis core{static_cast<int>(counts_.size()),
                             counts_.data(),
                             static_cast<int>(consequents_N_.size()),
                             centres_.data(),
                             widths_.data(),
                             consequents_N_.data()};
    std::vector<double> grades(centres_.size());
    return quiesce_anfis_N(&core, u.data(), grades.data());
}

} // namespace quiesce
