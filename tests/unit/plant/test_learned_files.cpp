/// Files of learned damper models: what is read, and what mistakes are answered with.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "damper_section.h"
#include "file_mistakes.h"

namespace {

using quiesce::Mistake;

const char *const kFiles[] = {
    R"(model = "anfis"
stroke_m = 0.01
speed_m_s = 0.2
[parameters]
consequents_N = [-10, 5, 10, 20]
[parameters.current_A]
range = [0.0, 1.0]
centres = [0.0, 1.0]
widths = [0.5, 0.5]
[parameters.velocity_m_s]
range = [-0.2, 0.2]
centres = [-0.2, 0.2]
widths = [0.1, 0.1]
)",
    R"(model = "ts_fuzzy"
stroke_m = 0.01
speed_m_s = 0.2
[parameters]
[parameters.velocity_m_s]
range = [-0.2, 0.2]
[[parameters.rule]]
centre = [0.0]
width = [0.5]
gain_N = [100.0]
offset_N = 1.0
)",
    R"(model = "recurrent_network"
stroke_m = 0.01
speed_m_s = 0.2
[parameters]
force_scale_N = 100.0
sample_time_s = 0.001
lags = [0, 2]
feedback = [1]
[parameters.velocity_m_s]
range = [-0.2, 0.2]
[[parameters.layer]]
units = 2
weights = [1, 2, 3, 4, 5, 6]
biases = [0, 0]
[[parameters.layer]]
units = 1
weights = [1, 1]
biases = [0]
)",
    R"(model = "support_vector"
stroke_m = 0.01
speed_m_s = 0.2
[parameters]
force_scale_N = 100.0
gamma = 1.0
intercept = 0.0
coefficients = [1.0, -1.0]
support_vectors = [0.5, -0.5]
[parameters.velocity_m_s]
range = [-0.2, 0.2]
)",
    R"(model = "neuro_fuzzy_stf"
stroke_m = 0.01
speed_m_s = 0.2
[parameters]
force_scale_N = 100.0
disp_scale_m = 0.01
velocity_scale_m_s = 0.1
current_scale_A = 1.0
conjunction = "product"
outputs = [-1, -0.7, 0, 0.7, 1]
gains = [0.2, 0.4, 0.6, 0.8, 1.0]
rules = [0,0,1,2,4, 0,1,1,3,4, 0,1,2,3,4, 0,1,3,3,4, 0,2,3,4,4]
[parameters.displacement]
centres = [-1, -0.5, 0, 0.5, 1]
bases = [1, 1, 1, 1, 1]
[parameters.velocity]
centres = [-1, -0.5, 0, 0.5, 1]
bases = [1, 1, 1, 1, 1]
[parameters.current]
centres = [0, 0.25, 0.5, 0.75, 1]
bases = [0.5, 0.5, 0.5, 0.5, 0.5]
)",
    R"(model = "hysteresis_network"
stroke_m = 0.01
speed_m_s = 0.2
[parameters]
force_scale_N = 100.0
current_scale_A = 1.0
field_order = 1
stop_reaches_m = [0.001]
feature_means = [0, 0, 0]
feature_scales = [1, 1, 1]
clip = 6.0
skip = [1, 2, 3, 4, 5, 6]
[[parameters.member]]
[[parameters.member.layer]]
units = 2
weights = [1, 2, 3, 4, 5, 6]
biases = [0, 0]
)",
    R"(model = "hilbert_network"
stroke_m = 0.01
speed_m_s = 0.2
[parameters]
force_scale_N = 100.0
sample_time_s = 0.001
lags = [0, 2]
[parameters.quadrature]
window_s = 0.5
envelope_m = 0.01
lowest_rad_s = 3.0
highest_rad_s = 60.0
[parameters.velocity_m_s]
range = [-0.2, 0.2]
[[parameters.layer]]
units = 1
weights = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]
biases = [0]
)",
};

enum File { anfis, ts_fuzzy, recurrent, support_vector, stf_file, hysteresis, hilbert };

std::string damper_file(const std::string &body) {
    return "schema = \"quiesce-damper\"\nversion = 1\nname = \"test\"\n" + body;
}

struct FileMistake {
    File file;
    Mistake mistake;
};

void PrintTo(const FileMistake &one, std::ostream *out) {
    *out << one.mistake.name;
}

class LearnedFileMistakes : public testing::TestWithParam<FileMistake> {};

TEST_P(LearnedFileMistakes, are_named) {
    const FileMistake &one = GetParam();
    quiesce::expect_message(quiesce::spoilt(damper_file(kFiles[one.file]), one.mistake),
                            one.mistake.words, quiesce::load_damper);
}

const FileMistake kFileMistakes[] = {
    {anfis,
     {"few_consequents", "[-10, 5, 10, 20]", "[-10, 5, 10]",
      "parameters.consequents_N: expected an array of 4 numbers, found 3"}},
    {anfis, {"nan_consequent", "-10, 5", "nan, 5", "parameters.consequents_N: expected a number"}},
    {anfis,
     {"zero_width", "widths = [0.1, 0.1]", "widths = [0.1, 0.0]",
      "parameters.velocity_m_s.widths: expected numbers > 0"}},
    {anfis,
     {"negative_width", "widths = [0.5, 0.5]", "widths = [-0.5, 0.5]",
      "parameters.current_A.widths: expected numbers > 0"}},
    {anfis,
     {"few_widths", "widths = [0.1, 0.1]", "widths = [0.1]",
      "parameters.velocity_m_s.widths: expected an array of 2 numbers, found 1"}},
    {anfis,
     {"empty_range", "range = [0.0, 1.0]", "range = [1.0, 1.0]",
      "parameters.current_A.range: expected [min, max] with min < max"}},
    {anfis, {"no_stroke", "stroke_m = 0.01", "", "stroke_m: missing"}},
    {anfis,
     {"unknown_key", "widths = [0.1, 0.1]", "widths = [0.1, 0.1]\nsigma = 1",
      "parameters.velocity_m_s.sigma: unknown key"}},
    {anfis,
     {"other_input", "parameters.velocity_m_s", "parameters.velocity_mm_s",
      "parameters.velocity_m_s: missing"}},
    {ts_fuzzy, {"no_rules", "parameters.rule", "parameters.rules", "parameters.rule: missing"}},
    {ts_fuzzy,
     {"wide_rule", "gain_N = [100.0]", "gain_N = [100.0, 1.0]",
      "parameters.rule[1].gain_N: expected an array of 1 numbers, found 2"}},
    {ts_fuzzy,
     {"zero_cluster", "width = [0.5]", "width = [0]",
      "parameters.rule[1].width: expected numbers > 0"}},
    {recurrent,
     {"few_weights", "[1, 2, 3, 4, 5, 6]", "[1, 2, 3, 4]",
      "parameters.layer[1].weights: expected an array of 6 numbers, found 4"}},
    {recurrent,
     {"two_outputs", "units = 1", "units = 2",
      "parameters.layer[2].units: expected an integer in 1 .. 1, found 2"}},
    {recurrent,
     {"infinite_weight", "weights = [1, 1]", "weights = [1, inf]",
      "parameters.layer[2].weights: expected a number"}},
    {recurrent,
     {"present_force", "feedback = [1]", "feedback = [0]",
      "parameters.feedback: expected integers that rise, in 1 .. 10000"}},
    {recurrent,
     {"falling_lags", "lags = [0, 2]", "lags = [2, 0]",
      "parameters.lags: expected integers that rise, in 0 .. 10000"}},
    {recurrent,
     {"half_lag", "lags = [0, 2]", "lags = [0, 1.5]",
      "parameters.lags: expected integers that rise"}},
    {recurrent,
     {"no_time", "sample_time_s = 0.001", "sample_time_s = 0.0",
      "parameters.sample_time_s: expected a number in"}},
    {recurrent,
     {"temperature", "[parameters.velocity_m_s]",
      "[parameters.temperature_C]\nrange = [0, 50]\n[parameters.velocity_m_s]",
      "parameters.temperature_C: a network with delays has no temperature"}},
    {support_vector,
     {"few_vectors", "[0.5, -0.5]", "[0.5]",
      "parameters.support_vectors: expected an array of 2 numbers, found 1"}},
    {support_vector, {"no_gamma", "gamma = 1.0", "gamma = 0.0", "parameters.gamma: expected"}},
    {support_vector,
     {"no_scale", "force_scale_N = 100.0", "force_scale_N = -1.0",
      "parameters.force_scale_N: expected a number in"}},
    {stf_file, {"label_five", "rules = [0,", "rules = [5,", "parameters.rules: expected 25"}},
    {stf_file,
     {"few_rules", "rules = [0,0,", "rules = [0,",
      "parameters.rules: expected an array of 25 numbers, found 24"}},
    {stf_file,
     {"unsorted_centres", "[-1, -0.5, 0,", "[-0.5, -1, 0,",
      "parameters.displacement.centres: expected numbers that rise"}},
    {stf_file,
     {"zero_base", "bases = [0.5,", "bases = [0,",
      "parameters.current.bases: expected numbers > 0"}},
    {stf_file,
     {"conjunction", "\"product\"", "\"sum\"",
      "parameters.conjunction: expected one of: product, minimum"}},
    {hysteresis,
     {"few_means", "feature_means = [0, 0, 0]", "feature_means = [0, 0]",
      "parameters.feature_means: expected an array of 3 numbers, found 2"}},
    {hysteresis,
     {"zero_scale", "feature_scales = [1, 1, 1]", "feature_scales = [1, 0, 1]",
      "parameters.feature_scales: expected numbers > 0"}},
    {hysteresis,
     {"few_heads", "field_order = 1", "field_order = 2",
      "parameters.skip: expected an array of 9 numbers, found 6"}},
    {hysteresis,
     {"few_weights", "weights = [1, 2, 3, 4, 5, 6]", "weights = [1, 2]",
      "parameters.member[1].layer[1].weights: expected an array of 6"}},
    {hysteresis,
     {"unknown_base", "[[parameters.member]]",
      "[parameters.base]\nmodel = \"none\"\n[[parameters.member]]",
      "parameters.base.model: expected one of"}},
    {hilbert,
     {"no_quadrature", "[parameters.quadrature]", "[parameters.other]",
      "parameters.quadrature: missing"}},
    {hilbert,
     {"no_window", "window_s = 0.5", "window_s = 0.0",
      "parameters.quadrature.window_s: expected a number in"}},
    {hilbert,
     {"falling_band", "highest_rad_s = 60.0", "highest_rad_s = 3.0",
      "parameters.quadrature.highest_rad_s: expected more than lowest_rad_s"}},
    {hilbert,
     {"unknown_key", "window_s = 0.5", "window_s = 0.5\nphase = 1",
      "parameters.quadrature.phase: unknown key"}},
    {hilbert,
     {"weights_without_features", "[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]", "[1, 2]",
      "parameters.layer[1].weights: expected an array of 10 numbers, found 2"}},
};

INSTANTIATE_TEST_SUITE_P(Learned, LearnedFileMistakes, testing::ValuesIn(kFileMistakes),
                         [](const testing::TestParamInfo<FileMistake> &one) {
                             return std::string(one.param.mistake.name) + "_" +
                                    std::to_string(one.index);
                         });

TEST(LearnedFiles, good_ones_are_read) {
    for (const char *body : kFiles) {
        const quiesce::TemporaryFile file(damper_file(body));
        const auto damper = quiesce::load_damper(file.path()).damper;
        std::vector<double> state(damper->state_count(), 0.0);
        std::vector<double> rates(state.size());
        const double force_N = damper->force_N({0.05, 0.001, 0.5}, state.data(), rates.data());
        EXPECT_TRUE(std::isfinite(force_N)) << body;
    }
}

TEST(LearnedFiles, a_base_must_not_sample) {
    const std::string base = "[parameters.base]\nmodel = \"feed_forward_network\"\n"
                             "stroke_m = 1.0\nspeed_m_s = 1.0\n[parameters.base.parameters]\n"
                             "force_scale_N = 1.0\nsample_time_s = 0.001\nlags = [0]\n"
                             "[parameters.base.parameters.velocity_m_s]\nrange = [-1.0, 1.0]\n"
                             "[[parameters.base.parameters.layer]]\nunits = 1\nweights = [1.0]\n"
                             "biases = [0.0]\n[[parameters.member]]";
    quiesce::expect_message(
        quiesce::spoilt(damper_file(kFiles[hysteresis]),
                        {"", "[[parameters.member]]", base.c_str(), ""}),
        "parameters.base: a model with a sample time of its own cannot be a base",
        quiesce::load_damper);
}

} // namespace
