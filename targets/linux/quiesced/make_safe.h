/// The second way to the safe current: brings every output of the configuration that ran to its
/// safe state when the program itself has died. systemd runs it as ExecStopPost.
#ifndef QUIESCED_MAKE_SAFE_H
#define QUIESCED_MAKE_SAFE_H

#include <string>

#include "config.h"

namespace quiesced {

/// The outputs of a configuration that another one does not have. An output that both have, with
/// whatever settings and for whatever damper, is left out: by the other's it is safe, by these it
/// may not be.
Config other_outputs(const Config &config, const Config &other);

/// First what the last controller ran with, as it has kept it, then other outputs that the file has
/// now, all of them where nothing is kept. Does all it can whatever fails, with a line on stderr
/// for each failure; of a file that has mistakes it uses what can be read. Returns 0, or 1 where
/// something failed (mistakes in the file count where nothing is kept) or a controller still runs,
/// which it leaves alone.
int make_safe(const std::string &config_file, const SystemFolders &folders = {});

/// The same, by who knows that no controller runs: it holds the instance lock itself.
int make_outputs_safe(const std::string &config_file, const std::string &state_folder,
                      const SystemFolders &folders);

} // namespace quiesced

#endif
