/// Where a run was while its law was at work, and what of that the law's table does not cover.
#ifndef QUIESCE_VISITS_H
#define QUIESCE_VISITS_H

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "run.h"
#include "table_range.h"

namespace quiesce {

/// How often which values > 0 came, within 1 %.
class Spread {
  public:
    void add(double value);
    std::int64_t count() const { return count_; }

    /// From its 5 % to its 95 %; of those outside of a range, with how many of all they are.
    /// count() must be above 0; nothing where none is outside.
    Span most() const;
    struct Outside {
        double part; ///< of all, 0 .. 1
        Span most;
    };
    std::optional<Outside> outside(const Span &range) const;

  private:
    std::map<int, std::int64_t> bins_; ///< by logarithm
    std::int64_t count_ = 0;
};

/// Ticks in which the law's request passed the guard and the frequency was known: one in ten of
/// them, which no tone is too fast for.
class VisitObserver final : public TickObserver {
  public:
    void on_tick(const TickRecord &record) override { add(record.tick, record.reply.telemetry); }
    void add(std::int64_t tick, const quiesce_telemetry_t &now);

    const Spread &freq_Hz() const { return freq_Hz_; }
    const Spread &rms_m_s2() const { return rms_m_s2_; }
    bool wants_current() const { return wants_current_; }         ///< in one of them
    std::int64_t ticks_at_work() const { return ticks_at_work_; } ///< known frequency or not

  private:
    Spread freq_Hz_;
    Spread rms_m_s2_;
    bool wants_current_ = false;
    std::int64_t ticks_at_work_ = 0;
};

/// What of a run a table does not cover, each in one line; none where all is well.
std::vector<std::string> warnings_of(const TableRange &range, const VisitObserver &visits);

} // namespace quiesce

#endif
