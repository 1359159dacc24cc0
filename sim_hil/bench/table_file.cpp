#include "table_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>

#include "input_error.h"
#include "param_options.h"

namespace quiesce {

namespace {

const char *reason(quiesce_table_verdict_t verdict) {
    switch (verdict) {
    case QUIESCE_TABLE_OK:
        return "accepted";
    case QUIESCE_TABLE_SIZE:
        return "it is shorter than it says, or too long";
    case QUIESCE_TABLE_MAGIC:
        return "it is not a table for this law, or one of another version";
    case QUIESCE_TABLE_CRC:
        return "its checksum is wrong: it is damaged";
    case QUIESCE_TABLE_SHAPE:
        return "its numbers of inputs, outputs, rules or points are out of range";
    case QUIESCE_TABLE_CELL:
        return "a membership is out of range";
    case QUIESCE_TABLE_RULE:
        return "a rule names what is not there";
    case QUIESCE_TABLE_OUTPUT:
        return "a term is out of range";
    case QUIESCE_TABLE_FIT:
        return "the controller's rules have two inputs, frequency in uHz and RMS acceleration in "
               "um/s2, and one output, current in mA; compile them with --controller";
    case QUIESCE_TABLE_POINT:
        return "its frequencies do not rise, or a floor is above its level; a force map's axes do "
               "not rise from below 0 to above it (currents: from 0 to 20 A at most), or its force "
               "does not grow with the current";
    case QUIESCE_TABLE_BOARD:
        return "it is made for another board";
    }
    return "unknown reason";
}

/// A table in a text file, for messages.
struct TextTable {
    const char *name;
    const char *writer;
};

std::uint32_t word_of(const std::string &text, const std::string &place, const TextTable &table) {
    std::size_t used = 0;
    unsigned long value = 0;
    try {
        value = std::stoul(text, &used, 16);
    } catch (const std::exception &) {
        used = 0;
    }
    if (used != text.size() || text.empty() || text[0] == '-' || value > UINT32_MAX) {
        throw InputError(place + ": '" + text.substr(0, 20) +
                         "' is no 32-bit hexadecimal number; " + table.writer +
                         " writes such files");
    }
    return static_cast<std::uint32_t>(value);
}

constexpr std::size_t kWordBytes = 4;
constexpr const char *kRefused = "the controller refuses the table: ";

std::uint32_t word_at(const std::vector<char> &bytes, std::size_t offset) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < kWordBytes; ++i) {
        word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i]))
                << (8U * i);
    }
    return word;
}

std::vector<std::uint32_t> text_words(const std::string &file, const TextTable &table) {
    std::ifstream stream(file);
    if (!stream) {
        throw InputError(file + ": cannot be read");
    }
    std::vector<std::uint32_t> words;
    std::string text;
    while (stream >> text) {
        const std::string place = file + ", word " + std::to_string(words.size() + 1);
        words.push_back(word_of(text, place, table));
    }
    if (words.empty()) {
        throw InputError(file + ": holds no words of a " + table.name);
    }
    return words;
}

/// The controller's reason, in words of the laws that are tables.
const char *reason_of_form(quiesce_table_verdict_t verdict) {
    if (verdict == QUIESCE_TABLE_FIT) {
        return "it needs a signal or a damper that this board does not have, or is made for "
               "another "
               "tick_rate_Hz (quiesce law show says what it needs, quiesce board show what there "
               "is)";
    }
    if (verdict == QUIESCE_TABLE_SHAPE) {
        return "its numbers of states, inputs, rows, sections, signs, terms, layers or units are "
               "out of "
               "range, or it takes too long for a tick";
    }
    return verdict == QUIESCE_TABLE_POINT
               ? "a coefficient, limit, band, power or current is out of range"
               : reason(verdict);
}

/// What a controller with this law says of them.
void try_table(const std::string &file, std::int32_t law, const std::vector<std::uint32_t> &words) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.law = law;
    const auto controller = std::make_unique<quiesce_t>();
    quiesce_init(controller.get(), &params);
    try {
        use_table(*controller, words);
    } catch (const InputError &error) {
        throw InputError(file + ": " + error.what());
    }
}

} // namespace

void use_table(quiesce_t &controller, const std::vector<std::uint32_t> &words) {
    const quiesce_table_verdict_t verdict =
        quiesce_table_use(&controller, words.data(), static_cast<std::uint32_t>(words.size()));
    if (verdict != QUIESCE_TABLE_OK) {
        throw InputError(kRefused + std::string(reason(verdict)));
    }
}

std::vector<std::uint32_t> load_rules(const std::string &file) {
    std::vector<std::uint32_t> words =
        text_words(file, {"rule table", "quiesce rules compile --words"});
    try_table(file, QUIESCE_LAW_FUZZY, words);
    return words;
}

namespace {

/// First words of trackers' tables that are no maps; require_tables asks the tracker itself.
constexpr std::uint32_t kOtherTrackers[] = {0x314E5451, 0x314B4251}; // network, bank

bool is_of_other_tracker(const std::vector<std::uint32_t> &words) {
    return std::find(std::begin(kOtherTrackers), std::end(kOtherTrackers), words[0]) !=
           std::end(kOtherTrackers);
}

} // namespace

std::vector<std::uint32_t> load_force_map(const std::string &file) {
    std::vector<std::uint32_t> words = text_words(file, {"force map", "quiesce identify inverse"});
    if (is_of_other_tracker(words)) {
        return words;
    }
    quiesce_owner_t owner = QUIESCE_OF_LAW;
    const bool is_trackers =
        quiesce_table_kind(words[0], &owner) != nullptr && owner == QUIESCE_OF_TRACKER;
    const quiesce_table_verdict_t verdict =
        is_trackers ? quiesce_table_check(words.data(), static_cast<std::uint32_t>(words.size()))
                    : QUIESCE_TABLE_MAGIC;
    if (verdict != QUIESCE_TABLE_OK) {
        throw InputError(file + ": " + kRefused + reason(verdict));
    }
    return words;
}

std::vector<std::uint32_t> load_law_table(const std::string &file) {
    return text_words(file, {"law's table", "quiesce law make"});
}

namespace {

void require_accepted_table(quiesce_t &controller, const std::string &file) {
    const std::vector<std::uint32_t> words = load_law_table(file);
    const quiesce_table_verdict_t verdict =
        quiesce_table_use(&controller, words.data(), static_cast<std::uint32_t>(words.size()));
    if (verdict != QUIESCE_TABLE_OK) {
        throw InputError(file + ": " + kRefused + reason_of_form(verdict));
    }
}

/// A map or bank that is good in itself: of this board's dampers and strokes, of this tick rate.
void require_served_map(quiesce_t &controller, const std::string &file) {
    const std::vector<std::uint32_t> words = load_force_map(file);
    const quiesce_table_verdict_t verdict =
        quiesce_table_use(&controller, words.data(), static_cast<std::uint32_t>(words.size()));
    if (verdict == QUIESCE_TABLE_FIT && !is_of_other_tracker(words)) {
        throw InputError(file + ": the controller refuses the map: it is of more dampers than this "
                                "board has, or over a stroke that no sensor tells (quiesce board "
                                "show), or a bank for another tick_rate_Hz");
    }
    if (verdict != QUIESCE_TABLE_OK) {
        throw InputError(file + ": " + kRefused + reason_of_form(verdict));
    }
}

} // namespace

void require_tables(const quiesce_board_t *board, const quiesce_params_t &params,
                    const std::string &law_table, const std::string &force_map) {
    const auto controller = std::make_unique<quiesce_t>();
    if (board != nullptr) {
        quiesce_init_board(controller.get(), board, &params);
    } else {
        quiesce_init(controller.get(), &params);
    }
    if (!law_table.empty()) {
        require_accepted_table(*controller, law_table);
    }
    const char *lacking = quiesce_lacks_table(controller.get());
    if (lacking != nullptr && law_label(params) == lacking) {
        throw InputError("law " + std::string(lacking) +
                         " works with a table: --law-table FILE (quiesce law make)");
    }
    if (lacking != nullptr && force_map.empty()) {
        throw InputError("tracker " + std::string(lacking) +
                         " works with a damper's map: --force-map FILE (quiesce identify inverse)");
    }
    if (lacking != nullptr) {
        require_served_map(*controller, force_map);
    }
}

std::vector<std::uint32_t> load_pulses(const std::string &file) {
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
    try_table(file, QUIESCE_LAW_PHASE, words);
    return words;
}

} // namespace quiesce
