/// Tables for the controller's laws, from files: rules as `quiesce rules compile` writes them,
/// pulses as `quiesce tune` does; systems, signs, friction and polynomials as `quiesce law make`
/// does; a damper's map for its tracker, from `quiesce identify inverse`.
#ifndef QUIESCE_TABLE_FILE_H
#define QUIESCE_TABLE_FILE_H

#include <cstdint>
#include <string>
#include <vector>

#include "firmware.h"

namespace quiesce {

/// Words of a file with one hexadecimal number a line. Throws InputError where the file cannot be
/// read, holds anything else or nothing, or where the fuzzy laws refuse the table.
std::vector<std::uint32_t> load_rules(const std::string &file);

/// Likewise a damper's map; throws InputError also where no law of the build demands forces.
/// Another tracker's table is taken by its first word: require_tables says whether the tracker
/// takes it.
std::vector<std::uint32_t> load_force_map(const std::string &file);

/// Likewise any table of the law that runs; whether that law takes it is not looked at.
std::vector<std::uint32_t> load_law_table(const std::string &file);

/// Words of a binary file, little-endian. Throws InputError where the file cannot be read, does not
/// hold whole words, or where law phase refuses the table.
std::vector<std::uint32_t> load_pulses(const std::string &file);

/// Throws InputError where a controller with this board (null: none) and parameters refuses
/// law_table or, after it, force_map (file names, empty: none given), or lacks one of them.
void require_tables(const quiesce_board_t *board, const quiesce_params_t &params,
                    const std::string &law_table, const std::string &force_map);

/// A verdict in words: what is wrong with a table.
const char *reason(quiesce_table_verdict_t verdict);

/// Makes a controller use them. Throws InputError where its law refuses.
void use_table(quiesce_t &controller, const std::vector<std::uint32_t> &words);

} // namespace quiesce

#endif
