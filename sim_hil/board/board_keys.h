/// The keys of board files that hold numbers, and the kinds of sensors. Ranges and defaults are the
/// firmware's own (quiesce_board_check, quiesce_board_default).
#ifndef QUIESCE_BOARD_KEYS_H
#define QUIESCE_BOARD_KEYS_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "quiesce_board.h"

namespace quiesce {

/// Thousandths of its unit that a count is on the board.
constexpr double kScalesPerUnit = 1000.0;

/// An integer of one table, by the name of its field.
template <class Part>
struct NumberKey {
    const char *key;
    const char *unit; ///< "": none
    std::int32_t Part::*field;
    bool is_required;
};

using SensorKey = NumberKey<quiesce_board_sensor_t>;
using DamperKey = NumberKey<quiesce_board_damper_t>;
using RootKey = NumberKey<quiesce_board_t>;

const std::vector<RootKey> &root_keys();
const std::vector<SensorKey> &sensor_keys();
const std::vector<DamperKey> &damper_keys();

enum class Owner { Body, Damper, Board };

/// What a sensor measures.
struct Sense {
    const char *name; ///< in `measures`
    Owner owner;      ///< what `of` names
    const char *unit;
    const char *scale_key;
};

/// By quiesce_sense_t.
const std::vector<Sense> &senses();

/// Letters of the axes by their numbers.
const std::vector<std::string> &axes();

struct FieldRange {
    std::int32_t min;
    std::int32_t max;
};

/// What quiesce_board_check allows for a field in this build.
FieldRange range_of(std::int32_t quiesce_board_t::*field);
FieldRange range_of(std::int32_t quiesce_board_sensor_t::*field);
FieldRange range_of(std::int32_t quiesce_board_damper_t::*field);

} // namespace quiesce

#endif
