#include "phase_table_file.h"

#include <fstream>
#include <iterator>
#include <memory>

#include "input_error.h"

namespace quiesce {

namespace {

const char *reason(quiesce_phase_verdict_t verdict) {
    switch (verdict) {
    case QUIESCE_PHASE_OK:
        return "accepted";
    case QUIESCE_PHASE_SIZE:
        return "it is shorter than it says, or too long";
    case QUIESCE_PHASE_MAGIC:
        return "it is not a table of pulses, or one of another version";
    case QUIESCE_PHASE_CRC:
        return "its checksum is wrong: it is damaged";
    case QUIESCE_PHASE_SHAPE:
        return "its numbers of points are out of range";
    case QUIESCE_PHASE_POINT:
        return "its frequencies do not rise, or a floor is above its level";
    }
    return "unknown reason";
}

constexpr std::size_t kWordBytes = 4;

std::uint32_t word_at(const std::vector<char> &bytes, std::size_t offset) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < kWordBytes; ++i) {
        word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i]))
                << (8U * i);
    }
    return word;
}

} // namespace

void use_phase_table(quiesce_t &controller, const std::vector<std::uint32_t> &words) {
    const quiesce_phase_verdict_t verdict = quiesce_phase_table_use(
        &controller, words.data(), static_cast<std::uint32_t>(words.size()));
    if (verdict != QUIESCE_PHASE_OK) {
        throw InputError(std::string("the controller refuses the table of pulses: ") +
                         reason(verdict));
    }
}

std::vector<std::uint32_t> load_phase_table(const std::string &file) {
    std::ifstream stream(file, std::ios::binary);
    const std::vector<char> bytes((std::istreambuf_iterator<char>(stream)),
                                  std::istreambuf_iterator<char>());
    if (!stream || bytes.empty()) {
        throw InputError(file + ": cannot be read, or is empty");
    }
    if (bytes.size() % kWordBytes != 0) {
        throw InputError(file + ": " + std::to_string(bytes.size()) +
                         " bytes are no whole 32-bit words; quiesce tune writes such files");
    }
    std::vector<std::uint32_t> words;
    for (std::size_t offset = 0; offset < bytes.size(); offset += kWordBytes) {
        words.push_back(word_at(bytes, offset));
    }
    quiesce_params_t params;
    quiesce_params_default(&params);
    const auto controller = std::make_unique<quiesce_t>();
    quiesce_init(controller.get(), &params);
    try {
        use_phase_table(*controller, words);
    } catch (const InputError &error) {
        throw InputError(file + ": " + error.what());
    }
    return words;
}

} // namespace quiesce
