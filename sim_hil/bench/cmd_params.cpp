/// params: every parameter of the controller as JSON.
#include <iostream>

#include "arguments.h"
#include "commands.h"
#include "firmware.h"
#include "json.h"

namespace quiesce {

namespace {

Json describe(const quiesce_param_info_t &info) {
    Json out = {{"name", info.name},
                {"unit", info.unit},
                {"min", info.min},
                {"max", info.max},
                {"default", info.default_value},
                {"choices", nullptr},
                {"labels", nullptr}};
    if (info.choices != nullptr) {
        out.set("choices", std::vector<int>(info.choices, info.choices + info.choice_count));
    }
    if (info.labels != nullptr) {
        out.set("labels", std::vector<std::string>(info.labels, info.labels + info.max + 1));
    }
    return out;
}

} // namespace

int cmd_params(const std::vector<std::string> &words) {
    Arguments("params", words, {}).require_no_positional();
    Json list = Json::array();
    for (std::uint32_t index = 0; index < QUIESCE_PARAM_COUNT; ++index) {
        list.push_back(describe(*quiesce_param_info(index)));
    }
    std::cout << list.dump(1) << '\n';
    return 0;
}

} // namespace quiesce
