/// plant-check: validates a plant file and shows what it describes.
#include <cmath>
#include <cstdio>

#include "arguments.h"
#include "commands.h"
#include "plant_file.h"

namespace quiesce {

namespace {

constexpr double kTwoPi = 6.28318530717958647692;

void print_modes(const PlantModel &model) {
    const Structure &structure = model.structure;
    for (Eigen::Index i = 0; i < structure.mode_count(); ++i) {
        const double omega = std::sqrt(structure.omega2_rad2_s2[i]);
        const double ratio = omega > 0.0 ? 0.5 * structure.damping_1_s(i, i) / omega : 0.0;
        std::printf("  mode %d: %.4g Hz, damping %.3g %%, shape at force %.4g",
                    static_cast<int>(i) + 1, omega / kTwoPi, 100.0 * ratio, structure.at_force[i]);
        for (const PlantDamper &one : model.dampers) {
            std::printf(", %s %.4g", label(one).c_str(), one.stroke[i]);
        }
        std::printf(", sensor %.4g", structure.at_sensor[i]);
        for (const Place &place : model.places) {
            std::printf(", %s %.4g", place.name.c_str(), place.shape[i]);
        }
        std::printf(" kg^-1/2, base %.4g kg^1/2\n", structure.base_participation[i]);
    }
    if (!structure.is_proportional) {
        std::printf("  damping couples the modes: simulated with the full matrix\n");
    }
}

void print_damper(const PlantDamper &one, double full_A) {
    const std::string name = label(one);
    std::printf("  %s: at most %.4g N s/m at %g A; coil %g/%g ms rise/fall, "
                "%g %% remanence\n",
                name.c_str(), one.damper->stiffest_N_s_m(full_A), full_A, 1e3 * one.coil.rise_s,
                1e3 * one.coil.fall_s, 100.0 * one.coil.remanence);
    if (one.damper->stiffest_N_m(full_A) > 0.0) {
        std::printf("  %s: a stiffness of %.4g N/m at 0 A, %.4g N/m at %g A\n", name.c_str(),
                    one.damper->stiffest_N_m(0.0), one.damper->stiffest_N_m(full_A), full_A);
    }
}

void print_mounts(const PlantModel &model) {
    for (const PlantMount &one : model.mounts) {
        std::printf("  mount: at most %.4g N/m and %.4g N s/m; shape", one.mount->stiffest_N_m(),
                    one.mount->stiffest_N_s_m());
        for (Eigen::Index i = 0; i < one.stroke.size(); ++i) {
            std::printf(" %.4g", one.stroke[i]);
        }
        std::printf(" kg^-1/2\n");
    }
}

void print_places(const PlantModel &model) {
    for (const Place &place : model.places) {
        std::printf("  place %s: moves with %g of the base\n", place.name.c_str(), place.base);
    }
    for (const auto &[sensor, rms] : model.noise) {
        std::printf("  noise of sensor %s: %g RMS a sample\n", sensor.c_str(), rms);
    }
}

} // namespace

int cmd_plant_check(const std::vector<std::string> &words) {
    const Arguments arguments("plant-check", words, {});
    const std::string file = arguments.only_positional("FILE");
    const PlantModel model = load_plant(file);
    std::printf("%s: plant %s is valid\n", file.c_str(), model.name.c_str());
    print_modes(model);
    for (const PlantDamper &one : model.dampers) {
        print_damper(one, model.driver.max_current_A);
    }
    print_mounts(model);
    print_places(model);
    std::printf("  sensor: +-%g g, %d bits, %g mg noise; drive %g V%s; integration step %g us "
                "(at most %.0f us)\n",
                model.sensor.full_scale_g, model.sensor.bits, model.sensor.noise_mg,
                model.shaker.drive_V, model.shaker.moves_base ? " of its base" : "",
                1e6 * model.max_step_s, 1e6 * longest_safe_step_s(model));
    return 0;
}

} // namespace quiesce
