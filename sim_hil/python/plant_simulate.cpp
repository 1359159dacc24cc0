#include "plant_simulate.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "input_error.h"
#include "plant.h"
#include "plant_handle.h"

namespace quiesce {

namespace {

constexpr double kTwoPi = 6.28318530717958647692;

/// The shaker under a drive that is given at every tick.
class TickSegment final : public Segment {
  public:
    TickSegment(const ShakerParams &shaker, const quiesce_drive &drive)
        : shaker_(shaker), drive_(drive) {}

    ExcitationSample sample(double time_s, double start_cycles) const override {
        const double tick = time_s * drive_.tick_rate_Hz;
        // The last stretch goes on: its slope holds at the last tick, too.
        const auto last = static_cast<double>(drive_.ticks - 2);
        const auto at = static_cast<std::size_t>(std::clamp(std::floor(tick), 0.0, last));
        const std::size_t next = at + 1;
        const double part = tick - static_cast<double>(at);
        const double slope = drive_.phase_cycles[next] - drive_.phase_cycles[at];
        const double cycles = drive_.phase_cycles[at] + part * slope;
        const double amplitude_V =
            drive_.amplitude_V[at] + part * (drive_.amplitude_V[next] - drive_.amplitude_V[at]);
        const double freq_Hz = std::abs(slope) * drive_.tick_rate_Hz;
        return shaker_.sample(amplitude_V * shaker_.amplitude(freq_Hz) * std::sin(kTwoPi * cycles),
                              freq_Hz, start_cycles + cycles);
    }

  private:
    Shaker shaker_;
    quiesce_drive drive_;
};

void simulate(const PlantModel &model, const quiesce_drive &drive,
              const quiesce_response &response) {
    if (drive.tick_rate_Hz < 1 || drive.tick_rate_Hz > 1000000 || drive.ticks < 2) {
        throw InputError("simulation: expected 1 to 1000000 ticks a second and 2 ticks or more");
    }
    ShakerParams shaker = model.shaker;
    shaker.drive_V = 1.0;
    Excitation excitation;
    excitation.append(std::make_unique<TickSegment>(shaker, drive), 1.0);
    Plant plant(model, excitation, drive.tick_rate_Hz);
    for (std::size_t tick = 0; tick < drive.ticks; ++tick) {
        const PlantTruth &truth = plant.truth();
        response.accel_m_s2[tick] = truth.accel_m_s2;
        if (response.disp_m != nullptr) {
            response.disp_m[tick] = truth.displacement_m;
        }
        if (response.coil_A != nullptr) {
            response.coil_A[tick] = truth.coil_A;
        }
        plant.command(0, drive.command_A[tick], ActuatorFault::none);
        plant.advance();
    }
}

} // namespace

} // namespace quiesce

int quiesce_plant_simulate(const quiesce_plant *plant, const quiesce_drive *drive,
                           const quiesce_response *response, char *error, std::size_t error_size) {
    return quiesce::guarded([&] { quiesce::simulate(plant->model, *drive, *response); }, error,
                            error_size);
}
