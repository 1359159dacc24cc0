#include "plant_handle.h"

#include <cmath>
#include <memory>
#include <utility>

#include "plant_file.h"

namespace {

constexpr double kTwoPi = 6.28318530717958647692;

} // namespace

quiesce_plant *quiesce_plant_load(const char *file, char *error, std::size_t error_size) {
    std::unique_ptr<quiesce_plant> plant;
    const auto work = [&] {
        quiesce::PlantModel model = quiesce::load_plant(file);
        quiesce::require_one_damper(model);
        plant = std::make_unique<quiesce_plant>(quiesce_plant{std::move(model)});
    };
    quiesce::guarded(work, error, error_size);
    return plant.release();
}

void quiesce_plant_free(quiesce_plant *plant) {
    const std::unique_ptr<quiesce_plant> owner(plant);
}

void quiesce_plant_get_facts(const quiesce_plant *plant, quiesce_plant_facts *facts) {
    const quiesce::PlantModel &model = plant->model;
    *facts = {model.driver.max_current_A,
              model.shaker.drive_V,
              model.max_step_s,
              quiesce::longest_safe_step_s(model),
              model.dampers[0].coil.rise_s,
              model.dampers[0].coil.fall_s,
              model.driver.bits,
              static_cast<int>(model.structure.mode_count())};
}

void quiesce_plant_get_mode(const quiesce_plant *plant, int mode, quiesce_plant_mode *out) {
    const quiesce::Structure &structure = plant->model.structure;
    const double omega = std::sqrt(structure.omega2_rad2_s2[mode]);
    *out = {omega / kTwoPi, omega > 0.0 ? 0.5 * structure.damping_1_s(mode, mode) / omega : 0.0,
            structure.at_force[mode], plant->model.dampers[0].stroke[mode],
            structure.at_sensor[mode]};
}

double quiesce_plant_shaker_per_V(const quiesce_plant *plant, double freq_Hz) {
    quiesce::ShakerParams shaker = plant->model.shaker;
    shaker.drive_V = 1.0;
    return quiesce::Shaker(shaker).amplitude(freq_Hz);
}
