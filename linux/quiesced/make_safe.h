/// The second way to the safe current: brings every output of a configuration to its safe state
/// when the program itself has died. systemd runs it as ExecStopPost.
#ifndef QUIESCED_MAKE_SAFE_H
#define QUIESCED_MAKE_SAFE_H

#include <string>

namespace quiesced {

/// Does all it can whatever fails, with a line on stderr for each failure; of a configuration that
/// has mistakes it uses what can be read. Returns 0, or 1 where something failed or a controller
/// still runs, which it leaves alone.
int make_safe(const std::string &config_file);

} // namespace quiesced

#endif
