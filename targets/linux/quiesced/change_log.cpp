#include "change_log.h"

#include <algorithm>

#include "clock.h"
#include "names.h"

namespace quiesced {

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

} // namespace

bool ChangeLog::Counted::is_news(std::uint32_t count, std::int64_t now_ns) {
    if (count == told || now_ns < next_ns) {
        return false;
    }
    told = count;
    next_ns = now_ns + kSecond_ns;
    return true;
}

/// One that heals and comes again has one place: it must not push the others out.
void ChangeLog::keep_fault(const quiesce_telemetry_t &telemetry) {
    auto *at = std::find_if(faults_.begin(), faults_.end(), [&](const FaultEvent &event) {
        return event.fault == telemetry.fault;
    });
    const bool is_known = at != faults_.end();
    at = is_known ? at : faults_.end() - 1;
    const std::uint32_t times = is_known ? at->times : 0;
    std::move_backward(faults_.begin(), at, at + 1);
    faults_.front() = {telemetry.fault, telemetry.tick, realtime_ns(),
                       times + (times < UINT32_MAX ? 1U : 0U)};
}

void ChangeLog::control(const quiesce_telemetry_t &telemetry) {
    if (telemetry.state == state_ && telemetry.fault == fault_) {
        return;
    }
    const bool has_fault = telemetry.fault != QUIESCE_FAULT_NONE;
    if (has_fault && telemetry.fault != fault_) {
        keep_fault(telemetry);
    }
    state_ = telemetry.state;
    fault_ = telemetry.fault;
    log_.log(has_fault ? LogLevel::warning : LogLevel::info, "state %s, fault %s in tick %u",
             state_name(state_), fault_name(fault_), static_cast<unsigned>(telemetry.tick));
}

void ChangeLog::bus(const can_bus_t *bus) {
    const can_bus_event_t &event = *can_bus_last_event(bus);
    if (event.number == bus_event_) {
        return;
    }
    bus_event_ = event.number;
    const can_bus_counters_t &counters = *can_bus_counters(bus);
    log_.log(can_bus_state(bus) == CAN_BUS_UP ? LogLevel::info : LogLevel::warning,
             "CAN: %s (since the start: down %u, bus-off %u, restarts %u, dropped %u, overruns %u)",
             event.text, static_cast<unsigned>(counters.down),
             static_cast<unsigned>(counters.bus_off), static_cast<unsigned>(counters.restarts),
             static_cast<unsigned>(counters.tx_dropped), static_cast<unsigned>(counters.overruns));
}

void ChangeLog::overruns(std::uint32_t overruns, LossCause cause, std::int64_t now_ns) {
    if (overruns_.is_news(overruns, now_ns)) {
        log_.log(LogLevel::warning, "%u ticks lost since the start, the last one: %s",
                 static_cast<unsigned>(overruns), loss_text(cause));
    }
}

void ChangeLog::failed_writes(std::size_t number, const char *title, std::uint32_t failures,
                              std::int64_t now_ns) {
    if (failed_writes_[number].is_news(failures, now_ns)) {
        log_.log(LogLevel::error, "%s: %u writes failed or were not held", title,
                 static_cast<unsigned>(failures));
    }
}

} // namespace quiesced
