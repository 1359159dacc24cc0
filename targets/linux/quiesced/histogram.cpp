#include "histogram.h"

#include <array>
#include <cstdio>

namespace quiesced {

namespace {

double mean_us(const tick_histogram_t &histogram) {
    const auto total_us = static_cast<double>(histogram.total_ns) / 1000.0;
    return histogram.count == 0 ? 0.0 : total_us / static_cast<double>(histogram.count);
}

std::string with_tenths(double value) {
    std::array<char, 40> text{};
    (void)std::snprintf(text.data(), text.size(), "%.1f", value);
    return text.data();
}

double worst_us(const tick_histogram_t &histogram) {
    return static_cast<double>(histogram.worst_ns) / 1000.0;
}

/// The bins that are not empty: before, upper end in us, between, count.
std::string bins(const tick_histogram_t &histogram, const char *before, const char *between) {
    std::string out;
    for (unsigned i = 0; i < TICK_HISTOGRAM_BINS; ++i) {
        if (histogram.bins[i] > 0) {
            out += (out.empty() ? "" : ", ") + std::string(before) + std::to_string(1UL << i) +
                   between + std::to_string(histogram.bins[i]);
        }
    }
    return out;
}

} // namespace

std::string histogram_line(const tick_histogram_t &histogram) {
    return std::to_string(histogram.count) + " ticks, mean " + with_tenths(mean_us(histogram)) +
           " us, worst " + with_tenths(worst_us(histogram)) + " us; " + bins(histogram, "<", "us ");
}

std::string histogram_json(const tick_histogram_t &histogram) {
    return "{\"count\": " + std::to_string(histogram.count) +
           ", \"mean_us\": " + with_tenths(mean_us(histogram)) +
           ", \"worst_us\": " + with_tenths(worst_us(histogram)) + ", \"below_us\": {" +
           bins(histogram, "\"", "\": ") + "}}";
}

} // namespace quiesced
