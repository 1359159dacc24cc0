/// What command run answers: one scenario in closed loop, one JSON object.
#ifndef QUIESCE_RUN_ANSWER_H
#define QUIESCE_RUN_ANSWER_H

#include <string>
#include <vector>

#include "json.h"

namespace quiesce {

struct RunAnswer {
    Json json;
    std::vector<std::string> warnings; ///< in it, too
};

/// words: options of run. Keeps nothing from one call to the next. Throws InputError.
RunAnswer run_answer(const std::vector<std::string> &words);

} // namespace quiesce

#endif
