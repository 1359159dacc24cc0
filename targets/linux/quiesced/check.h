/// Explains what is wrong with a configuration, then what of this machine does not fit it.
#ifndef QUIESCED_CHECK_H
#define QUIESCED_CHECK_H

#include <string>

namespace quiesced {

/// Prints each mistake, or that there is none and notes about devices and rights, on stdout.
/// Touches no device. Returns 0, or 2 where the file has mistakes.
int check(const std::string &config_file);

} // namespace quiesced

#endif
