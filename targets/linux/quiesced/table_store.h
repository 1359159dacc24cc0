/// Tables and what was learnt that outlive the program, as files of the state folder. All of it
/// blocks on the disk: never call it from the control loop.
#ifndef QUIESCED_TABLE_STORE_H
#define QUIESCED_TABLE_STORE_H

#include <string>

#include "config.h"

namespace quiesced {

/// What a table was stored over: it is used as long as the configuration says the same.
struct StoredOver {
    std::uint32_t configured = 0; ///< CRC-32 of the table that the configuration names, 0: none
    std::uint32_t board = 0;      ///< of the words of its board, 0: it has none
};

/// By road (table_service.h).
inline keeper_record_t record_of(std::uint32_t road) {
    return static_cast<keeper_record_t>(KEEPER_LAW_TABLE + road);
}
inline std::uint32_t road_of(keeper_record_t record) {
    return static_cast<std::uint32_t>(record) - KEEPER_LAW_TABLE;
}

struct StoredTable {
    TableWords words;         ///< empty: there is none, or it is not used
    std::uint32_t writes = 0; ///< of the record, so far
    keeper_state_t state = KEEPER_WHOLE;
};

/// Records of keeper.h but KEEPER_PARAMS.
class TableStore {
  public:
    explicit TableStore(const std::string &folder) : folder_(folder) {}

    /// *note says, in a line, why what is there is not used; empty: it is, or there is nothing.
    StoredTable load(keeper_record_t record, const StoredOver &over, std::string &note) const;

    /// count 0: forgets the record. Returns why it failed; empty: saved.
    std::string save(keeper_record_t record, const StoredOver &over, const std::uint32_t *words,
                     std::uint32_t count);

    std::string file(keeper_record_t record) const;

  private:
    std::string folder_;
};

} // namespace quiesced

#endif
