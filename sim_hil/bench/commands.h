/// Commands of quiesce_bench: one file cmd_*.cpp each, one line in main.cpp's table.
#ifndef QUIESCE_COMMANDS_H
#define QUIESCE_COMMANDS_H

#include <string>
#include <vector>

namespace quiesce {

/// words: what follows the command's name. Prints its result on stdout and returns the exit code;
/// throws InputError for what the user can put right.
using Command = int (*)(const std::vector<std::string> &words);

int cmd_board_check(const std::vector<std::string> &words);
int cmd_board_keys(const std::vector<std::string> &words);
int cmd_compare(const std::vector<std::string> &words);
int cmd_count(const std::vector<std::string> &words);
int cmd_fuzzy_surface(const std::vector<std::string> &words);
int cmd_live(const std::vector<std::string> &words);
int cmd_params(const std::vector<std::string> &words);
int cmd_plant_check(const std::vector<std::string> &words);
int cmd_replay(const std::vector<std::string> &words);
int cmd_run(const std::vector<std::string> &words);
int cmd_scenario_check(const std::vector<std::string> &words);
int cmd_serve(const std::vector<std::string> &words);
int cmd_table_check(const std::vector<std::string> &words);
int cmd_uart_rate(const std::vector<std::string> &words);

} // namespace quiesce

#endif
