/// Pieces that files of several learned models share.
#ifndef QUIESCE_LEARNED_KEYS_H
#define QUIESCE_LEARNED_KEYS_H

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "input_box.h"
#include "network.h"
#include "toml_table.h"

namespace quiesce {

/// Largest number of rules, vectors, features and so on that a file may hold.
constexpr std::size_t kMostItems = 100000;

double read_force_scale_N(TomlTable &keys);

/// length numbers (any count >= 1 where it is 0), each > 0.
std::vector<double> positive_numbers(TomlTable &keys, const std::string &key, std::size_t length);
/// The same, empty where the key is missing.
std::vector<double> optional_positive_numbers(TomlTable &keys, const std::string &key);
/// Integers that rise from `least` or more, at most `most`.
std::vector<int> rising_integers(TomlTable &keys, const std::string &key, int least, int most);

/// The tables current_A, displacement_m, velocity_m_s and temperature_C, those that there are, with
/// range = [min, max] in each; `more` reads what else an input's table holds. At least one of
/// displacement and velocity.
InputBox read_inputs(TomlTable &keys, const std::function<void(TomlTable &)> &more = {});

/// [[layer]] with units, weights (units rows of inputs) and biases.
Network read_network(TomlTable &keys, std::size_t inputs, std::size_t outputs);

} // namespace quiesce

#endif
