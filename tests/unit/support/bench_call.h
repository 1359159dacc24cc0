/// Calls of the bench executable as a user makes them, from the repository's root.
#ifndef QUIESCE_TEST_BENCH_CALL_H
#define QUIESCE_TEST_BENCH_CALL_H

#include <sys/wait.h>

#include <cstdio>
#include <string>

namespace quiesce {

struct Outcome {
    int exit_code;
    std::string output; ///< stdout and stderr together
};

/// One word for the shell; for paths without an apostrophe.
inline std::string quoted(const std::string &path) {
    return "'" + path + "'";
}

/// Runs quiesce_bench (QUIESCE_BENCH is its path) through the shell.
inline Outcome bench(const std::string &words, const std::string &environment = "") {
    const std::string command = environment + " " + quoted(QUIESCE_BENCH) + " " + words + " 2>&1";
    std::FILE *pipe = popen(command.c_str(), "r");
    Outcome out{-1, ""};
    char buffer[4096];
    for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
        out.output.append(buffer, n);
    }
    out.exit_code = WEXITSTATUS(pclose(pipe));
    return out;
}

/// The JSON object that ends what was printed, after warnings.
inline std::string json_text(const Outcome &outcome) {
    const std::size_t start = outcome.output.find('{');
    return start == std::string::npos ? outcome.output : outcome.output.substr(start);
}

} // namespace quiesce

#endif
