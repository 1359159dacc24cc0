#include "visits.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace quiesce {

namespace {

constexpr double kBin = 0.00995; // ln 1.01
constexpr double kLeast = 1e-9;
constexpr std::int64_t kEvery = 10; // ticks
constexpr double kEdge = 0.05;      // of most()

// A tone at a table's end is not beyond it for an estimate's noise.
constexpr double kMargin = 1.05;
// Below the first set a level is small, and rules say what to do with small ones: it is only beyond
// them where it is so much smaller that they were made for something else.
constexpr double kSmallLevel = 10.0;
constexpr double kTold = 0.05; // of the time
constexpr double kAll = 0.95;

double value_of(int bin) {
    return std::exp(kBin * bin);
}

using Bins = std::map<int, std::int64_t>;

/// The value below which this part of them lies.
double quantile(const Bins &bins, std::int64_t count, double part) {
    const double wanted = part * static_cast<double>(count);
    std::int64_t seen = 0;
    for (const auto &[bin, ticks] : bins) {
        seen += ticks;
        if (static_cast<double>(seen) >= wanted) {
            return value_of(bin);
        }
    }
    return value_of(bins.rbegin()->first);
}

Span most_of(const Bins &bins, std::int64_t count) {
    return {quantile(bins, count, kEdge), quantile(bins, count, 1.0 - kEdge)};
}

/// digits: as many as are known.
std::string text_of(const Span &span, const char *unit, int digits) {
    std::ostringstream out;
    out.precision(digits);
    out << span.low;
    if (span.high > kMargin * span.low) {
        out << " to " << span.high;
    }
    out << ' ' << unit;
    return out.str();
}

void tell(const Span &covered, const Spread &visited, const Span &allowed, const std::string &what,
          const char *unit, std::vector<std::string> &out) {
    const auto outside = visited.outside(allowed);
    if (!outside || outside->part < kTold) {
        return;
    }
    std::string text =
        what + text_of(covered, unit, 3) + "; this run is at " + text_of(outside->most, unit, 2);
    if (outside->part < kAll) {
        text += " for " + std::to_string(std::lround(100.0 * outside->part)) + " % of its time";
    }
    out.push_back(text);
}

} // namespace

void Spread::add(double value) {
    ++bins_[static_cast<int>(std::lround(std::log(std::max(value, kLeast)) / kBin))];
    ++count_;
}

Span Spread::most() const {
    return most_of(bins_, count_);
}

std::optional<Spread::Outside> Spread::outside(const Span &range) const {
    Bins beyond;
    std::int64_t count = 0;
    for (const auto &[bin, ticks] : bins_) {
        if (value_of(bin) < range.low || value_of(bin) > range.high) {
            beyond[bin] = ticks;
            count += ticks;
        }
    }
    if (count == 0) {
        return std::nullopt;
    }
    return Outside{static_cast<double>(count) / static_cast<double>(count_),
                   most_of(beyond, count)};
}

void VisitObserver::add(std::int64_t tick, const quiesce_telemetry_t &now) {
    const bool is_at_work = now.state == QUIESCE_STATE_RUN || now.state == QUIESCE_STATE_DEGRADED;
    ticks_at_work_ += is_at_work ? 1 : 0;
    if (!is_at_work || now.freq_is_valid == 0) {
        return;
    }
    wants_current_ = wants_current_ || now.current_law_mA > 0;
    if (tick % kEvery == 0) {
        freq_Hz_.add(1e-6 * now.freq_uHz);
        rms_m_s2_.add(1e-6 * now.rms_um_s2);
    }
}

std::vector<std::string> warnings_of(const TableRange &range, const VisitObserver &visits) {
    std::vector<std::string> out;
    if (visits.freq_Hz().count() == 0) {
        if (visits.ticks_at_work() > 0) {
            out.push_back("no frequency was found anywhere in this run, so the " + range.kind +
                          " were never asked: a constant current was held");
        }
        return out;
    }
    if (range.freq_Hz) {
        const Span &covered = *range.freq_Hz;
        tell(covered, visits.freq_Hz(), {covered.low / kMargin, covered.high * kMargin},
             range.kind + " cover ", "Hz", out);
    }
    if (range.rms_m_s2) {
        const Span &covered = *range.rms_m_s2;
        tell(covered, visits.rms_m_s2(), {covered.low / kSmallLevel, covered.high * kMargin},
             range.kind + " cover ", "m/s2 RMS", out);
    }
    if (!visits.wants_current()) {
        out.push_back("the " + range.kind + " ask for no current anywhere in this run");
    }
    return out;
}

} // namespace quiesce
