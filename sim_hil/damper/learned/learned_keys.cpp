#include "learned_keys.h"

#include <cmath>

namespace quiesce {

namespace {

struct InputName {
    InputKind kind;
    const char *key;
};

constexpr InputName kInputNames[] = {
    {InputKind::current, "current_A"},
    {InputKind::displacement, "displacement_m"},
    {InputKind::velocity, "velocity_m_s"},
    {InputKind::temperature, "temperature_C"},
};

InputRange read_range(TomlTable &input, InputKind kind) {
    const std::vector<double> range = input.numbers("range", 2);
    if (!(range[0] < range[1])) {
        input.fail("range", "expected [min, max] with min < max");
    }
    return {kind, range[0], range[1]};
}

} // namespace

double read_force_scale_N(TomlTable &keys) {
    return keys.number("force_scale_N", {1e-9, 1e12, "N"});
}

std::vector<double> positive_numbers(TomlTable &keys, const std::string &key, std::size_t length) {
    std::vector<double> out = keys.numbers(key, length);
    if (out.size() > kMostItems) {
        keys.fail(key, "expected at most " + std::to_string(kMostItems) + " numbers");
    }
    for (const double value : out) {
        if (!(value > 0.0)) {
            keys.fail(key, "expected numbers > 0");
        }
    }
    return out;
}

std::vector<double> optional_positive_numbers(TomlTable &keys, const std::string &key) {
    return keys.has(key) ? positive_numbers(keys, key, 0) : std::vector<double>{};
}

std::vector<int> rising_integers(TomlTable &keys, const std::string &key, int least, int most) {
    std::vector<int> out;
    double before = least - 1.0;
    for (const double value : keys.numbers(key, 0)) {
        if (value <= before || value > most || value != std::floor(value)) {
            keys.fail(key, "expected integers that rise, in " + std::to_string(least) + " .. " +
                               std::to_string(most));
        }
        before = value;
        out.push_back(static_cast<int>(value));
    }
    return out;
}

InputBox read_inputs(TomlTable &keys, const std::function<void(TomlTable &)> &more) {
    std::vector<InputRange> ranges;
    bool has_motion = false;
    for (const InputName &name : kInputNames) {
        std::optional<TomlTable> input = keys.optional_table(name.key);
        if (!input) {
            continue;
        }
        ranges.push_back(read_range(*input, name.kind));
        if (more) {
            more(*input);
        }
        input->reject_unknown_keys();
        has_motion =
            has_motion || name.kind == InputKind::displacement || name.kind == InputKind::velocity;
    }
    if (!has_motion) {
        keys.fail("velocity_m_s", "missing; expected a table with range = [min, max] for each "
                                  "input: current_A, displacement_m, velocity_m_s, temperature_C");
    }
    return InputBox(ranges);
}

Network read_network(TomlTable &keys, std::size_t inputs, std::size_t outputs) {
    std::vector<NetworkLayer> layers;
    std::vector<TomlTable> tables = keys.tables("layer");
    if (tables.empty()) {
        keys.fail("layer", "missing; expected tables [[...layer]] with units, weights and biases");
    }
    std::size_t from = inputs;
    for (TomlTable &table : tables) {
        const bool is_last = &table == &tables.back();
        const auto least = static_cast<std::int64_t>(is_last ? outputs : 1);
        const auto most = static_cast<std::int64_t>(is_last ? outputs : kMostUnits);
        const auto units = static_cast<std::size_t>(table.integer("units", least, most));
        layers.push_back(
            {from, units, table.numbers("weights", units * from), table.numbers("biases", units)});
        table.reject_unknown_keys();
        from = units;
    }
    return Network(std::move(layers));
}

} // namespace quiesce
