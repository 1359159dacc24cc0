#include "two_storeys.h"

#include <filesystem>

namespace quiesced {

namespace {

const std::string kBoard = R"(schema = "quiesce-board"
version = 1
name = "two_storeys"
bodies = ["floor", "roof"]
tracked = "roof_accel"

[[sensor]]
name = "floor_accel"
measures = "acceleration"
of = "floor"
axis = "x"
scale_um_s2 = 57.751
full_scale_counts = 8388607

[[sensor]]
name = "roof_accel"
measures = "acceleration"
of = "roof"
axis = "y"
scale_um_s2 = 57.751
full_scale_counts = 8388607

[[sensor]]
name = "upper_stroke"
measures = "stroke"
of = "upper"
scale_nm = 1000.0
full_scale_counts = 32767

[[damper]]
name = "lower"
end_a = "floor"
end_b = "ground"
ceiling_mA = 2000
safe_mA = 40

[[damper]]
name = "upper"
end_a = "roof"
end_b = "floor"
ceiling_mA = 2000
safe_mA = 60
)";

} // namespace

TwoStoreys::TwoStoreys() {
    for (const char *device : {"iio/iio:device0", "iio/iio:device1", "iio/iio:device2",
                               "iio/iio:device3", "pwm/pwmchip0/pwm0"}) {
        std::filesystem::create_directories(folder / device);
    }
    write_text(folder / "rig.board.toml", kBoard);
    write_text(folder / "iio/iio:device0/name", "adxl355\n");
    write_text(folder / "iio/iio:device0/in_accel_x_raw", "1100\n");
    write_text(folder / "iio/iio:device0/in_accel_y_raw", "1101\n");
    write_text(folder / "iio/iio:device1/name", "adxl355\n");
    write_text(folder / "iio/iio:device1/in_accel_x_raw", "1200\n");
    write_text(folder / "iio/iio:device1/in_accel_y_raw", "1201\n");
    write_text(folder / "iio/iio:device2/name", "adc\n");
    write_text(folder / "iio/iio:device2/in_voltage0_raw", "300\n");
    write_text(folder / "iio/iio:device2/in_voltage1_raw", "-1301\n");
    write_text(folder / "iio/iio:device3/name", "dac\n");
    write_text(folder / "iio/iio:device3/out_voltage0_raw", "9999\n");
    write_text(folder / "pwm/pwmchip0/npwm", "1\n");
    for (const char *file : {"period", "duty_cycle", "enable"}) {
        write_text(folder / (std::string("pwm/pwmchip0/pwm0/") + file), "1\n");
    }
}

SystemFolders TwoStoreys::folders() const {
    return {folder / "iio", folder / "pwm", folder / "dev"};
}

void TwoStoreys::write_config(const std::string &begin) const {
    write_text(config_file(), "[board]\nfile = \"rig.board.toml\"\n[state]\nfolder = \"" +
                                  folder.path() + "\"\n" + begin + kSensors + kDampers + kEnable);
}

} // namespace quiesced
