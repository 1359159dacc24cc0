/// The lock-step server on a CAN bus: the controller on simulated peripherals, a tick for every
/// stimulus of the bench. No clock, no priorities, no other device.
#ifndef QUIESCED_LOCKSTEP_MODE_H
#define QUIESCED_LOCKSTEP_MODE_H

#include <string>

namespace quiesced {

/// Returns 0 after the bench's STOP or a signal. Throws InputError where it cannot start.
int run_lockstep(const std::string &config_file);

} // namespace quiesced

#endif
