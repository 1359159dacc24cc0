/// board-keys: every key of board files that holds a number, with its range and default, as JSON.
#include <iostream>

#include "arguments.h"
#include "board_keys.h"
#include "commands.h"
#include "json.h"

namespace quiesce {

namespace {

template <class Part>
void add_keys(Json &out, const char *table, const std::vector<NumberKey<Part>> &keys,
              const Part &defaults) {
    for (const NumberKey<Part> &key : keys) {
        const FieldRange range = range_of(key.field);
        out.push_back({{"table", table},
                       {"key", key.key},
                       {"unit", key.unit},
                       {"min", range.min},
                       {"max", range.max},
                       {"default", key.is_required ? Json() : Json(defaults.*key.field)}});
    }
}

void add_scales(Json &out) {
    const FieldRange range = range_of(&quiesce_board_sensor_t::scale);
    for (const Sense &sense : senses()) {
        out.push_back({{"table", "sensor"},
                       {"measures", sense.name},
                       {"key", sense.scale_key},
                       {"unit", sense.unit},
                       {"min", range.min / kScalesPerUnit},
                       {"max", range.max / kScalesPerUnit},
                       {"default", nullptr}});
    }
}

} // namespace

int cmd_board_keys(const std::vector<std::string> &words) {
    Arguments("board-keys", words, {}).require_no_positional();
    quiesce_board_t board;
    quiesce_board_default(&board);
    Json out = Json::array();
    add_keys(out, "", root_keys(), board);
    add_keys(out, "sensor", sensor_keys(), board.sensor[0]);
    add_keys(out, "damper", damper_keys(), board.damper[0]);
    add_scales(out);
    std::cout << out.dump(1) << '\n';
    return 0;
}

} // namespace quiesce
