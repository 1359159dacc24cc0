/// The [[segment]] sections of a scenario: one line in segment_section.cpp adds a kind.
#ifndef QUIESCE_SEGMENT_SECTION_H
#define QUIESCE_SEGMENT_SECTION_H

#include <functional>
#include <memory>
#include <string>

#include "segment.h"
#include "shaker.h"
#include "toml_table.h"

namespace quiesce {

/// What a segment acts through.
enum class ShakenBy {
    shaker, ///< the plant's, on the structure or below its base
    force,  ///< a force of its own at the shaker's place
    base,   ///< an acceleration of the base of its own
};

struct SegmentSpec {
    std::string summary; ///< for people
    double duration_s;
    ShakenBy by;
    std::function<std::unique_ptr<Segment>(const ShakerParams &shaker)> make;
};

/// A sine through the shaker that goes on for ever.
SegmentSpec lasting_sine(double freq_Hz);

/// Reads a segment, and what it refers to. is_last: it may go on for ever, where its kind allows
/// that. Throws InputError naming what is wrong.
SegmentSpec read_segment(TomlTable &section, bool is_last);

} // namespace quiesce

#endif
