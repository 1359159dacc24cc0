/// serve: runs one after another, each a line of standard input, for those who have thousands: a
/// process a run costs more than a short run does.
#include <exception>
#include <iostream>
#include <sstream>

#include "arguments.h"
#include "commands.h"
#include "run_answer.h"

namespace quiesce {

namespace {

std::vector<std::string> words_of(const std::string &line) {
    std::vector<std::string> words;
    std::istringstream in(line);
    for (std::string word; std::getline(in, word, '\t');) {
        words.push_back(word);
    }
    return words;
}

Json answer_to(const std::string &line) {
    try {
        return run_answer(words_of(line)).json;
    } catch (const std::exception &error) {
        return {{"refused", error.what()}};
    }
}

} // namespace

int cmd_serve(const std::vector<std::string> &words) {
    Arguments("serve", words, {}).require_no_positional();
    for (std::string line; std::getline(std::cin, line);) {
        std::cout << answer_to(line).dump() << std::endl; // NOLINT(performance-avoid-endl)
    }
    return 0;
}

} // namespace quiesce
