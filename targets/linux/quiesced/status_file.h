/// The status file: what the controller is doing, as JSON, for people and scripts.
#ifndef QUIESCED_STATUS_FILE_H
#define QUIESCED_STATUS_FILE_H

#include <string>

#include "exchange.h"

namespace quiesced {

std::string status_json(const Config &config, const Snapshot &snapshot);

/// Replaces a file as a whole (write aside, rename). It is not synced to the disk: after a power
/// failure it may be an old one, or gone. Returns why it failed; empty: written.
std::string replace_file(const std::string &file, const std::string &text);

} // namespace quiesced

#endif
