#include "table_range.h"

namespace quiesce {

namespace {

// firmware/fuzzy/fuzzy_table.h: words of the header, of a cell before its ramps, of a ramp.
constexpr std::uint32_t kRules = 0x31545A46;
constexpr std::uint32_t kAxisWord = 4;
constexpr std::uint32_t kUnitsWord = 15;
constexpr std::uint32_t kUnitsShift = 24; // 1: uHz and um/s2
constexpr std::uint32_t kCellWords = 4;
constexpr std::uint32_t kCellFirst = 1;
constexpr std::uint32_t kRampWords = 4;
constexpr std::uint32_t kRampSlope = 2;
constexpr double kPerUnit = 1e-6;

// firmware/law/phase/phase_table.h: two settings' numbers of points in a word; points of 4 words.
constexpr std::uint32_t kPulses = 0x31485051;
constexpr std::uint32_t kPointsWord = 3;
constexpr std::uint32_t kHeaderWords = 5;
constexpr std::uint32_t kPointWords = 4;
constexpr std::uint32_t kLow16 = 0xFFFF;
constexpr double kHzPerCount = 1e-3;

/// The cells of an input: they are over all of int32, in ascending order.
class Cells {
  public:
    Cells(const std::uint32_t *words, std::uint32_t axis)
        : at_(words + (axis & kLow16)), count_((axis >> 16U) & 0xFFU), stride_(axis >> 24U) {}

    std::uint32_t count() const { return count_; }
    double first(std::uint32_t cell) const {
        return static_cast<std::int32_t>(at_[cell * stride_ + kCellFirst]);
    }
    /// Every membership stays as it is over all of it.
    bool is_flat(std::uint32_t cell) const {
        for (std::uint32_t at = kCellWords; at < stride_; at += kRampWords) {
            if (at_[cell * stride_ + at + kRampSlope] != 0) {
                return false;
            }
        }
        return true;
    }

  private:
    const std::uint32_t *at_;
    std::uint32_t count_;
    std::uint32_t stride_;
};

std::optional<Span> span_of(const Cells &cells) {
    std::uint32_t begin = 0;
    while (begin < cells.count() && cells.is_flat(begin)) {
        ++begin;
    }
    if (begin == cells.count()) {
        return std::nullopt;
    }
    std::uint32_t end = cells.count();
    while (cells.is_flat(end - 1)) {
        --end;
    }
    const double high = end < cells.count() ? cells.first(end) : INT32_MAX;
    return Span{kPerUnit * cells.first(begin), kPerUnit * high};
}

std::optional<TableRange> range_of_rules(const std::uint32_t *words) {
    if (words[kUnitsWord] >> kUnitsShift != 1) {
        return std::nullopt;
    }
    return TableRange{"rules", span_of({words, words[kAxisWord]}),
                      span_of({words, words[kAxisWord + 1]})};
}

TableRange range_of_pulses(const std::uint32_t *words, std::int32_t setting) {
    const std::uint32_t counts = words[kPointsWord];
    const std::uint32_t before = setting == 0 ? 0 : counts & kLow16;
    const std::uint32_t count = setting == 0 ? counts & kLow16 : counts >> 16U;
    const auto freq_Hz = [&](std::uint32_t point) {
        return kHzPerCount * (words[kHeaderWords + kPointWords * (before + point)] & kLow16);
    };
    return {"pulses", Span{freq_Hz(0), freq_Hz(count - 1)}, std::nullopt};
}

} // namespace

std::optional<TableRange> range_of(const std::uint32_t *words, std::int32_t phase_setting) {
    if (words[0] == kRules) {
        return range_of_rules(words);
    }
    if (words[0] == kPulses) {
        return range_of_pulses(words, phase_setting);
    }
    return std::nullopt;
}

} // namespace quiesce
