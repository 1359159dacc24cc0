/// The acknowledgement without a bus: forgets the latched fault that a stopped controller has left.
#ifndef QUIESCED_CLEAR_FAULT_H
#define QUIESCED_CLEAR_FAULT_H

#include <string>

namespace quiesced {

/// Says on stdout what was forgotten. Returns 0. Throws InputError while a controller runs (it is
/// acknowledged over the bus, or stopped first), and where the record cannot be removed.
int clear_fault(const std::string &config_file);

} // namespace quiesced

#endif
