/// Options that every command with a closed loop shares.
#ifndef QUIESCE_RUN_OPTIONS_H
#define QUIESCE_RUN_OPTIONS_H

#include <memory>
#include <string>
#include <vector>

#include "arguments.h"
#include "link_factory.h"
#include "run.h"

namespace quiesce {

/// Option names: run_setup reads the first list, target_link the second, tables_from the third.
const std::vector<std::string> &run_option_names();
const std::vector<std::string> &target_option_names();
const std::vector<std::string> &table_option_names();

/// Concatenation of option lists.
std::vector<std::string> options(std::initializer_list<std::vector<std::string>> lists);

/// Throws InputError where the scenario shakes a base that the plant does not have.
void require_base(const Scenario &scenario, const PlantModel &plant);

/// Loads scenario and plant and applies every override. Throws InputError.
RunSetup run_setup(const Arguments &arguments);

/// The same of a scenario that is no file, or of one that has been loaded.
RunSetup setup_of(const Arguments &arguments, Scenario scenario);

/// Likewise of the plant of --plant by itself: what shakes it the caller appends.
RunSetup setup_of_plant(const Arguments &arguments, const std::string &name);

/// Defaults with --law and every --set applied and accepted. base: before those.
quiesce_params_t params_from(const Arguments &arguments, quiesce_params_t base);

/// The same for a board, which takes the place of some of them: those are refused.
quiesce_params_t params_for_board(const Arguments &arguments, quiesce_params_t base);

/// Tables for a controller with this board (null: none) and these parameters. Throws InputError
/// where a file holds no table of its option, or the law or its tracker refuses --law-table or
/// --force-map, or lacks one.
Tables tables_from(const Arguments &arguments, const quiesce_board_t *board,
                   const quiesce_params_t &params);

/// The link that the target options describe; the host without --target.
std::unique_ptr<ControllerLink> target_link(const Arguments &arguments);

} // namespace quiesce

#endif
