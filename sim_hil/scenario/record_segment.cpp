#include "record_segment.h"

#include <algorithm>

namespace quiesce {

RecordSegment::RecordSegment(std::vector<RecordPoint> points, double gain, double time_scale)
    : points_(std::move(points)) {
    const double start_s = points_.front().time_s;
    for (RecordPoint &point : points_) {
        point.time_s = (point.time_s - start_s) / time_scale;
        point.accel_m_s2 *= gain;
    }
}

ExcitationSample RecordSegment::sample(double time_s, double start_cycles) const {
    if (time_s > points_.back().time_s) {
        return {0.0, 0.0, start_cycles, 0.0};
    }
    const auto next = std::upper_bound(
        points_.begin() + 1, points_.end() - 1, time_s,
        [](double value_s, const RecordPoint &point) { return value_s < point.time_s; });
    const RecordPoint &from = *(next - 1);
    const double part = (time_s - from.time_s) / (next->time_s - from.time_s);
    const double accel_m_s2 = from.accel_m_s2 + part * (next->accel_m_s2 - from.accel_m_s2);
    return {0.0, 0.0, start_cycles, accel_m_s2};
}

} // namespace quiesce
