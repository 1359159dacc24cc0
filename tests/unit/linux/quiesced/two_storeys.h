/// A rig of two storeys for tests: a board of two accelerometers, a stroke sensor and two dampers
/// in a folder, with the kernel's folders for its devices.
#ifndef TWO_STOREYS_H
#define TWO_STOREYS_H

#include <string>

#include "config.h"
#include "temporary_folder.h"

namespace quiesced {

/// Tables of its sensors and dampers, as write_config writes them, not in the order of the board:
/// single readings, PWM, DAC.
inline const std::string kSensors = R"([[sensor]]
name = "upper_stroke"
source = "iio"
device = "adc"
channel = "in_voltage1_raw"
[[sensor]]
name = "roof_accel"
source = "iio"
device = "iio:device1"
use_buffer = false
[[sensor]]
name = "floor_accel"
source = "iio"
device = "iio:device0"
use_buffer = false
)";
inline const std::string kDampers = R"([[damper]]
name = "upper"
output = "dac"
device = "dac"
zero_code = 7
full_scale_code = 2007
full_scale_mA = 2000
[[damper]]
name = "lower"
output = "pwm"
chip = "pwmchip0"
period_ns = 20000
full_scale_mA = 2000
)";

/// What arms it.
inline const std::string kEnable = "[gpio]\nenable_input = { line = \"ENABLE\" }\n";

/// Safe currents of 40 and 60 mA, ceilings of 2 A.
class TwoStoreys {
  public:
    TwoStoreys();

    std::string config_file() const { return folder / "q.toml"; }
    /// The kernel's folders in it: accelerometers iio:device0 and 1, an ADC iio:device2, a DAC
    /// iio:device3 and pwmchip0.
    SystemFolders folders() const;
    /// Writes the configuration; begin: what comes before its [[sensor]] tables.
    void write_config(const std::string &begin = "") const;
    std::string text(const std::string &file) const { return read_text(folder / file); }
    /// Of a file of the kernel's, which a write does not shorten.
    std::string first_line(const std::string &file) const {
        const std::string all = text(file);
        return all.substr(0, all.find('\n'));
    }

    TemporaryFolder folder;
};

} // namespace quiesced

#endif
