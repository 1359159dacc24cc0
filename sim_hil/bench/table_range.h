/// Over which inputs a table of rules or pulses makes a difference, from its words.
#ifndef QUIESCE_TABLE_RANGE_H
#define QUIESCE_TABLE_RANGE_H

#include <cstdint>
#include <optional>
#include <string>

namespace quiesce {

struct Span {
    double low;
    double high;
};

/// Beyond it the table goes on as at its end.
struct TableRange {
    std::string kind; ///< "rules" or "pulses"
    std::optional<Span> freq_Hz;
    std::optional<Span> rms_m_s2; ///< of the acceleration; pulses: none
};

/// words: a table that a law has accepted. phase_setting: whose pulses. Returns nothing for other
/// kinds of tables. Of rules from the top of the first set, where membership begins to fall, to
/// that of the last one; nothing for an input whose sets tell nothing apart.
std::optional<TableRange> range_of(const std::uint32_t *words, std::int32_t phase_setting);

} // namespace quiesce

#endif
