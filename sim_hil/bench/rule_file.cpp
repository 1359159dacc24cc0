#include "rule_file.h"

#include <fstream>
#include <memory>

#include "input_error.h"

namespace quiesce {

namespace {

const char *reason(quiesce_rules_verdict_t verdict) {
    switch (verdict) {
    case QUIESCE_RULES_OK:
        return "accepted";
    case QUIESCE_RULES_SIZE:
        return "it is shorter than it says, or too long";
    case QUIESCE_RULES_MAGIC:
        return "it is not a rule table, or one of another version";
    case QUIESCE_RULES_CRC:
        return "its checksum is wrong: it is damaged";
    case QUIESCE_RULES_SHAPE:
        return "its numbers of inputs, outputs or rules are out of range";
    case QUIESCE_RULES_CELL:
        return "a membership is out of range";
    case QUIESCE_RULES_RULE:
        return "a rule names what is not there";
    case QUIESCE_RULES_OUTPUT:
        return "a term is out of range";
    case QUIESCE_RULES_FIT:
        return "the controller's rules have two inputs, frequency in uHz and RMS acceleration in "
               "um/s2, and one output, current in mA; compile them with --controller";
    }
    return "unknown reason";
}

std::uint32_t word_of(const std::string &text, const std::string &place) {
    std::size_t used = 0;
    unsigned long value = 0;
    try {
        value = std::stoul(text, &used, 16);
    } catch (const std::exception &) {
        used = 0;
    }
    if (used != text.size() || text.empty() || text[0] == '-' || value > UINT32_MAX) {
        throw InputError(place + ": '" + text.substr(0, 20) +
                         "' is no 32-bit hexadecimal number; quiesce rules compile --words "
                         "writes such files");
    }
    return static_cast<std::uint32_t>(value);
}

} // namespace

void use_rules(quiesce_t &controller, const std::vector<std::uint32_t> &words) {
    const quiesce_rules_verdict_t verdict =
        quiesce_rules_use(&controller, words.data(), static_cast<std::uint32_t>(words.size()));
    if (verdict != QUIESCE_RULES_OK) {
        throw InputError(std::string("the controller refuses the rule table: ") + reason(verdict));
    }
}

std::vector<std::uint32_t> load_rules(const std::string &file) {
    std::ifstream stream(file);
    if (!stream) {
        throw InputError(file + ": cannot be read");
    }
    std::vector<std::uint32_t> words;
    std::string text;
    while (stream >> text) {
        words.push_back(word_of(text, file + ", word " + std::to_string(words.size() + 1)));
    }
    if (words.empty()) {
        throw InputError(file + ": holds no words of a rule table");
    }
    quiesce_params_t params;
    quiesce_params_default(&params);
    const auto controller = std::make_unique<quiesce_t>();
    quiesce_init(controller.get(), &params);
    try {
        use_rules(*controller, words);
    } catch (const InputError &error) {
        throw InputError(file + ": " + error.what());
    }
    return words;
}

} // namespace quiesce
