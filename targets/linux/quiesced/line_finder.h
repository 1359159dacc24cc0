/// Looks a GPIO line up without requesting it.
#ifndef QUIESCED_LINE_FINDER_H
#define QUIESCED_LINE_FINDER_H

#include <string>

namespace quiesced {

/// What keeps a line ("ESTOP", "gpiochip0:3", "/dev/gpiochip0:3") from being used; "": nothing.
std::string line_trouble(const std::string &line);

} // namespace quiesced

#endif
