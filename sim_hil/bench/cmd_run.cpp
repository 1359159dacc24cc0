/// run: one scenario in closed loop, one JSON object.
#include <iostream>

#include "commands.h"
#include "run_answer.h"

namespace quiesce {

int cmd_run(const std::vector<std::string> &words) {
    const RunAnswer answer = run_answer(words);
    for (const std::string &warning : answer.warnings) {
        std::cerr << "quiesce_bench: warning: " << warning << '\n';
    }
    std::cout << answer.json.dump() << '\n';
    return 0;
}

} // namespace quiesce
