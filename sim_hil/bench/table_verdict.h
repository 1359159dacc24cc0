/// What the controller says of a table's words.
#ifndef QUIESCE_TABLE_VERDICT_H
#define QUIESCE_TABLE_VERDICT_H

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware.h"

namespace quiesce {

using TableWords = std::vector<std::uint32_t>;

/// A controller with this board; null: with the default one.
std::unique_ptr<quiesce_t> controller_with(const quiesce_board_t *board,
                                           const quiesce_params_t &params);

quiesce_table_verdict_t use_table(quiesce_t &controller, const TableWords &words);

/// Whichever law or tracker takes them, by themselves: no board is asked.
quiesce_table_verdict_t verdict_of(const TableWords &words);

/// Likewise with this board, at the tick rate that they are made for.
quiesce_table_verdict_t verdict_on(const quiesce_board_t &board, const TableWords &words);

/// Laws and trackers that work with a table of their kind, good or not.
struct Takers {
    std::vector<std::string> laws, trackers;
};
Takers takers_of(const TableWords &words);

/// A verdict in words: what is wrong with this table.
const char *reason_of(quiesce_table_verdict_t verdict, const TableWords &words);

} // namespace quiesce

#endif
