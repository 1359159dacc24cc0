/// What a start has of tables and of what was learnt.
#ifndef QUIESCED_START_TABLES_H
#define QUIESCED_START_TABLES_H

#include "table_files.h"
#include "table_store.h"

namespace quiesced {

struct StartTables {
    ConfiguredTables configured;           ///< empty also where a file cannot be used
    std::array<StoredTable, ROADS> stored; ///< by road
    std::vector<std::string> notes;        ///< lines on what is not used
};

/// Reads all of it. What cannot be used is no reason not to start.
StartTables find_tables(const Config &config);

} // namespace quiesced

#endif
