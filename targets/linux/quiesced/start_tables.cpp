#include "start_tables.h"

#include "input_error.h"

namespace quiesced {

namespace {

void read_configured(const Config &config, quiesce_owner_t owner, StartTables &tables) {
    try {
        tables.configured[owner] = load_table(config, owner, config.wiring());
    } catch (const quiesce::InputError &error) {
        tables.notes.emplace_back(error.what());
    }
}

} // namespace

StartTables find_tables(const Config &config) {
    StartTables tables;
    for (const quiesce_owner_t owner : kOwners) {
        read_configured(config, owner, tables);
    }
    const TableStore store(config.state.folder);
    for (std::uint32_t road = 0; road < ROADS; ++road) {
        const std::uint32_t configured =
            road < QUIESCE_TABLE_OWNERS ? crc_of(tables.configured[road]) : 0;
        std::string note;
        tables.stored[road] =
            store.load(record_of(road), {configured, table_file_board(config.wiring())}, note);
        if (!note.empty()) {
            tables.notes.push_back(note);
        }
    }
    return tables;
}

} // namespace quiesced
