/// The parts of the configuration that say what is wired to this machine: [accel] and [current], or
/// [board] with [[sensor]] and [[damper]] tables, one for each sensor and damper of the board.
#ifndef QUIESCED_WIRING_H
#define QUIESCED_WIRING_H

#include "config.h"
#include "section.h"

namespace quiesced {

/// Whether the file has a board or names one.
bool has_board(const Section &root);

/// Fills board, sensors and outputs; is_required: they must be there. board_file: instead of the
/// one that [board] names, "": that.
void read_wiring(Section &root, bool is_required, const std::string &board_file, Config &config);

} // namespace quiesced

#endif
