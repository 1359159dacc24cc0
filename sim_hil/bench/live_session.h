/// A rig in the computer: plant and controller in motion, and what a user changes meanwhile. The
/// protocol is docs/reference/rig-protocol.md.
#ifndef QUIESCE_LIVE_SESSION_H
#define QUIESCE_LIVE_SESSION_H

#include <memory>
#include <optional>
#include <string>

#include "digest.h"
#include "json.h"
#include "live_link.h"
#include "loop.h"
#include "pace.h"
#include "vibration.h"

namespace quiesce {

class LiveSession {
  public:
    /// link: must outlive it; it is started here. is_enabled: the operator's enable, from tick 1
    /// on. now_ns: when the first tick is due. Throws InputError where the controller refuses what
    /// it is started with.
    LiveSession(RunSetup setup, LiveLink &link, bool is_enabled, std::int64_t now_ns);

    const Pace &pace() const { return pace_; }

    /// Runs the tick that is due, which begins at now_ns, and has the controller told so. Throws
    /// TargetGone where the controller is.
    void tick(std::int64_t now_ns);

    /// Whether the controller has a clock of its own: then half_way is called, too.
    bool has_other_clock() const { return !link_.is_complete(); }

    /// Half-way between two ticks. Throws likewise.
    void half_way() { link_.half_way(); }

    /// The tick has taken so long.
    void worked(std::int64_t work_ns) {
        link_.pace().work_us = static_cast<std::uint32_t>(work_ns / 1000);
    }

    /// A line: the inside of an inline table of TOML, all of it or nothing. Throws InputError where
    /// it is not understood or allowed.
    void obey(const std::string &line);

    /// So many times a second, in even intervals of ticks.
    bool is_state_due(int times_per_s) const;

    /// What does not change: names, units, choices.
    Json introduction() const;
    /// Now. Whole or not at all in a pipe: shorter than 4096 bytes.
    Json state() const;
    /// What lock-step would have to give, too.
    Json summary() const;

  private:
    struct Order;

    Order order_of(const std::string &line);
    void play(const SegmentSpec &segment);
    void begin_anew();
    void stand_still(const std::string &why);
    Json pace_json() const;

    RunSetup setup_;
    LiveLink &link_;
    std::unique_ptr<Loop> loop_;
    Pace pace_;
    Vibration vibration_;
    DigestObserver digest_;
    std::string halt_; ///< why the plant had to be set up again, since the last order
};

} // namespace quiesce

#endif
