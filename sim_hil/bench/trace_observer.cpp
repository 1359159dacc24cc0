#include "trace_observer.h"

namespace quiesce {

namespace {

/// Of the plant: the truth, by the names of the board.
std::vector<std::string> own_names(const Rig *rig) {
    std::vector<std::string> names = {"t_s",      "x5_um",        "a5_mm_s2", "coil_A",
                                      "force_mN", "accel_counts", "flags"};
    if (rig == nullptr) {
        return names;
    }
    for (const std::string &sensor : rig->file.sensors) {
        names.push_back(sensor + "_counts");
    }
    for (const std::string &body : rig->file.bodies) {
        names.push_back(body + "_true_um");
        names.push_back(body + "_true_mm_s2");
    }
    for (const std::string &damper : rig->file.dampers) {
        names.push_back(damper + "_true_stroke_um");
        names.push_back(damper + "_true_force_mN");
        names.push_back(damper + "_true_mA");
    }
    return names;
}

} // namespace

TraceObserver::TraceObserver(std::int32_t law, const Rig *rig,
                             const std::optional<std::string> &columns, std::int64_t every)
    : rig_(rig), columns_(own_names(rig),
                          controller_columns(law, rig == nullptr ? nullptr : &rig->file), columns),
      every_(every), trace_(columns_.names()) {}

void TraceObserver::on_tick(const TickRecord &record) {
    if (record.tick % every_ != 0) {
        return;
    }
    const PlantTruth &truth = record.truth;
    row_ = {record.time_s,
            1e6 * truth.displacement_m,
            1e3 * truth.accel_m_s2,
            truth.coil_A,
            1e3 * truth.damper_force_N,
            static_cast<double>(record.stimulus.counts[0]),
            static_cast<double>(traced_flags(record.stimulus.flags))};
    if (rig_ != nullptr) {
        put_rig(record);
    }
    columns_.put(row_, record.reply, trace_);
}

void TraceObserver::put_rig(const TickRecord &record) {
    for (std::size_t i = 0; i < rig_->file.sensors.size(); ++i) {
        row_.push_back(record.stimulus.counts[i]);
    }
    for (const std::size_t place : rig_->place_of) {
        const PlaceTruth truth = record.plant.place(place);
        row_.push_back(1e6 * truth.displacement_m);
        row_.push_back(1e3 * truth.accel_m_s2);
    }
    for (const std::size_t damper : rig_->damper_of) {
        const DamperTruth truth = record.plant.damper(damper);
        row_.push_back(1e6 * truth.stroke_m);
        row_.push_back(1e3 * truth.force_N);
        row_.push_back(1e3 * truth.coil_A);
    }
}

} // namespace quiesce
