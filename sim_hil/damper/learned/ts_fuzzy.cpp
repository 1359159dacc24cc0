#include "ts_fuzzy.h"

#include <utility>

#include "ts_fuzzy_core.h"

namespace quiesce {

TsFuzzy::TsFuzzy(InputBox box, double stroke_m, const std::vector<FuzzyCluster> &clusters)
    : StaticDamper(std::move(box), stroke_m) {
    for (const FuzzyCluster &one : clusters) {
        centres_.insert(centres_.end(), one.centre.begin(), one.centre.end());
        widths_.insert(widths_.end(), one.width.begin(), one.width.end());
        gains_N_.insert(gains_N_.end(), one.gain_N.begin(), one.gain_N.end());
        offsets_N_.push_back(one.offset_N);
    }
}

double TsFuzzy::force_N(const DamperInput &input, const double * /*state*/,
                        double * /*rates*/) const {
    const Inputs u = box().scaled(input);
    const quiesce_ts_fuzzy core{static_cast<int>(box().count()),
                                static_cast<int>(offsets_N_.size()),
                                centres_.data(),
                                widths_.data(),
                                gains_N_.data(),
                                offsets_N_.data()};
    return quiesce_ts_fuzzy_N(&core, u.data());
}

} // namespace quiesce
