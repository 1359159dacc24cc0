#include "tones_segment.h"

namespace quiesce {

TonesSegment::TonesSegment(const ShakerParams &shaker_params, const std::vector<Tone> &tones)
    : shaker_(shaker_params) {
    for (const Tone &tone : tones) {
        lines_.push_back(
            {tone.freq_Hz, shaker_.amplitude(tone.freq_Hz, tone.size), tone.phase_deg / 360.0});
    }
}

ExcitationSample TonesSegment::sample(double time_s, double start_cycles) const {
    return shaker_.sample(sum_of_tones(lines_, time_s), 0.0, start_cycles);
}

} // namespace quiesce
