#include "trace_observer.h"

namespace quiesce {

TraceObserver::TraceObserver(std::int32_t law, const std::optional<std::string> &columns,
                             std::int64_t every)
    : columns_({"t_s", "x5_um", "a5_mm_s2", "coil_A", "force_mN", "accel_counts", "flags"}, law,
               columns),
      every_(every), trace_(columns_.names()) {}

void TraceObserver::on_tick(const TickRecord &record) {
    if (record.tick % every_ != 0) {
        return;
    }
    const PlantTruth &truth = record.truth;
    columns_.put({record.time_s, 1e6 * truth.displacement_m, 1e3 * truth.accel_m_s2, truth.coil_A,
                  1e3 * truth.damper_force_N, static_cast<double>(record.stimulus.counts[0]),
                  static_cast<double>(traced_flags(record.stimulus.flags))},
                 record.reply, trace_);
}

} // namespace quiesce
