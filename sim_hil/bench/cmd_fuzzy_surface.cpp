/// fuzzy-surface: the controller's rule base, or another, over its two inputs, as JSON.
#include <algorithm>
#include <cmath>
#include <iostream>

#include "arguments.h"
#include "commands.h"
#include "firmware.h"
#include "json.h"
#include "table_file.h"

namespace quiesce {

namespace {

constexpr std::size_t kPoints = 101;
constexpr double kFreqLast_Hz = 25.0;
constexpr double kRmsLast_m_s2 = 0.5;

std::vector<double> axis(double last) {
    std::vector<double> values(kPoints);
    for (std::size_t i = 0; i < kPoints; ++i) {
        values[i] = last * static_cast<double>(i) / (kPoints - 1);
    }
    return values;
}

std::int32_t micro(double value) {
    return static_cast<std::int32_t>(std::lround(value * 1e6));
}

} // namespace

int cmd_fuzzy_surface(const std::vector<std::string> &words) {
    const Arguments arguments("fuzzy-surface", words, {"rules"});
    arguments.require_no_positional();
    const auto given = load_tables({arguments.text("rules").value_or(""), "", "", ""});
    const std::uint32_t *table = given.empty() ? nullptr : given.front().data();
    const std::vector<double> freq_Hz = axis(kFreqLast_Hz);
    const std::vector<double> rms_m_s2 = axis(kRmsLast_m_s2);
    Json current_A = Json::array();
    for (const double f : freq_Hz) {
        std::vector<double> row(rms_m_s2.size());
        std::transform(rms_m_s2.begin(), rms_m_s2.end(), row.begin(), [&](double rms) {
            return quiesce_rules_current_mA(table, micro(f), micro(rms), nullptr) / 1000.0;
        });
        current_A.push_back(row);
    }
    const Json out = {{"freq_Hz", freq_Hz}, {"rms_m_s2", rms_m_s2}, {"current_A", current_A}};
    std::cout << out.dump() << '\n';
    return 0;
}

} // namespace quiesce
