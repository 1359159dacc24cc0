/// The one exception for what a user can put right: a file, an option, a value, a missing program.
#ifndef QUIESCE_INPUT_ERROR_H
#define QUIESCE_INPUT_ERROR_H

#include <stdexcept>

namespace quiesce {

/// what() is one line that says what is wrong and what to do. The bench prints it and exits with 2.
class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

} // namespace quiesce

#endif
