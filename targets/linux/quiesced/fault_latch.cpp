#include "fault_latch.h"

#include "names.h"

namespace quiesced {

std::uint32_t latched_fault(const node_t &node) {
    const quiesce_telemetry_t &telemetry = node.out.telemetry;
    const bool is_latched =
        telemetry.state == QUIESCE_STATE_FAULT && telemetry.fault != QUIESCE_FAULT_PARAMETER;
    return is_latched ? telemetry.fault : static_cast<std::uint32_t>(QUIESCE_FAULT_NONE);
}

FaultLatch::FaultLatch(Exchange &exchange)
    : exchange_(exchange), held_(exchange.latched_fault.load()), told_(held_),
      phase_(held_ == QUIESCE_FAULT_NONE ? Phase::nothing : Phase::holding) {}

void FaultLatch::before_tick(node_inputs_t &board) {
    is_pressed_ = board.estop;
    is_reset_ = board.fault_reset && !was_reset_high_;
    was_reset_high_ = board.fault_reset;
    board.estop = board.estop || phase_ == Phase::holding;
    board.fault_reset =
        phase_ == Phase::repeating || (board.fault_reset && phase_ != Phase::released);
}

void FaultLatch::let_go(const node_t &node) {
    const bool is_acknowledged = is_reset_ || node.bus.fault_reset;
    if (is_acknowledged && !is_pressed_ && !node.bus.estop) {
        phase_ = Phase::released;
        exchange_.log.log(LogLevel::warning, "fault %s of an earlier run is acknowledged",
                          fault_name(held_));
    }
}

void FaultLatch::keep_new(const node_t &node) {
    const std::uint32_t fault = latched_fault(node);
    if (phase_ == Phase::nothing && fault != QUIESCE_FAULT_NONE) {
        tell(fault);
    }
}

void FaultLatch::after_tick(const node_t &node) {
    switch (phase_) {
    case Phase::holding:
        let_go(node);
        break;
    case Phase::released:
        phase_ = Phase::repeating;
        break;
    case Phase::repeating:
        phase_ = Phase::nothing;
        held_ = QUIESCE_FAULT_NONE;
        break;
    case Phase::nothing:
        break;
    }
    tell(phase_ == Phase::nothing ? latched_fault(node) : held_);
}

void FaultLatch::tell(std::uint32_t fault) {
    if (fault != told_) {
        told_ = fault;
        exchange_.latched_fault.store(fault);
        exchange_.wake();
    }
}

} // namespace quiesced
