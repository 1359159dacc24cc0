#include "table_files.h"

#include <cstdio>
#include <memory>

#include "input_error.h"
#include "names.h"
#include "table_container.h"

namespace quiesced {

namespace {

std::string hex(std::uint32_t crc) {
    std::array<char, 11> text{};
    (void)std::snprintf(text.data(), text.size(), "0x%08x", static_cast<unsigned>(crc));
    return text.data();
}

std::string place_of(const Config &config, quiesce_owner_t owner) {
    return std::string("tables.") + owner_name(owner) + ": " + config.tables[owner];
}

void require_board(const std::string &place, std::uint32_t made_for, const quiesce_board_t *board) {
    const std::uint32_t own = table_file_board(board);
    if (made_for != 0 && made_for != own) {
        throw quiesce::InputError(place + ": made for board " + hex(made_for) + ", and this is " +
                                  (own == 0 ? "no board" : "board " + hex(own)) +
                                  "; make it anew, or say that it fits: quiesce table stamp");
    }
}

void require_owner(const std::string &place, const TableWords &words, quiesce_owner_t owner) {
    quiesce_owner_t found = owner;
    const char *kind = quiesce_table_kind(words.front(), &found);
    if (kind != nullptr && found != owner) {
        throw quiesce::InputError(place + ": a table of kind " + kind + " is for tables." +
                                  owner_name(found));
    }
}

} // namespace

TableWords load_table(const Config &config, quiesce_owner_t owner, const quiesce_board_t *board) {
    if (config.tables[owner].empty()) {
        return {};
    }
    const std::string place = place_of(config, owner);
    quiesce::TableContainer file;
    try {
        file = quiesce::read_table(config.tables[owner]);
    } catch (const quiesce::InputError &error) {
        throw quiesce::InputError(std::string("tables.") + owner_name(owner) + ": " + error.what());
    }
    require_board(place, file.board, board);
    require_owner(place, file.words, owner);
    const auto count = static_cast<std::uint32_t>(file.words.size());
    const quiesce_table_verdict_t verdict = quiesce_table_check(file.words.data(), count);
    if (verdict != QUIESCE_TABLE_OK) {
        throw quiesce::InputError(place + ": " + verdict_text(verdict));
    }
    return std::move(file.words);
}

ConfiguredTables load_tables(const Config &config, const quiesce_board_t *board) {
    ConfiguredTables tables;
    for (const quiesce_owner_t owner : kOwners) {
        tables[owner] = load_table(config, owner, board);
    }
    return tables;
}

void require_fit(const ConfiguredTables &tables, const Config &config, const quiesce_board_t *board,
                 const quiesce_params_t &params) {
    const auto controller = std::make_unique<quiesce_t>();
    (void)(board == nullptr ? quiesce_init(controller.get(), &params)
                            : quiesce_init_board(controller.get(), board, &params));
    for (const quiesce_owner_t owner : kOwners) {
        const TableWords &words = tables[owner];
        const auto count = static_cast<std::uint32_t>(words.size());
        const quiesce_table_verdict_t verdict =
            words.empty() ? QUIESCE_TABLE_OK
                          : quiesce_table_use(controller.get(), words.data(), count);
        if (verdict != QUIESCE_TABLE_OK) {
            throw quiesce::InputError(place_of(config, owner) + ": " + verdict_text(verdict));
        }
    }
}

} // namespace quiesced
