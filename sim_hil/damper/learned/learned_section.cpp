#include "learned_section.h"

#include <algorithm>

#include "anfis.h"
#include "hysteresis_network.h"
#include "learned_keys.h"
#include "neuro_fuzzy_stf.h"
#include "sampled_network.h"
#include "static_network.h"
#include "support_vector.h"
#include "ts_fuzzy.h"

namespace quiesce {

namespace {

constexpr int kMostLag = 10000;

GaussianSet read_gaussians(TomlTable &input) {
    GaussianSet set;
    set.centres = input.numbers("centres", 0);
    set.widths = positive_numbers(input, "widths", set.centres.size());
    return set;
}

void read_five(TomlTable &keys, const char *key, double *out) {
    const std::vector<double> values = keys.numbers(key, quiesce_stf_labels);
    std::copy(values.begin(), values.end(), out);
}

quiesce_triangles read_triangles(TomlTable keys) {
    quiesce_triangles set{};
    read_five(keys, "centres", set.centres);
    const std::vector<double> bases = positive_numbers(keys, "bases", quiesce_stf_labels);
    if (!std::is_sorted(set.centres, set.centres + quiesce_stf_labels)) {
        keys.fail("centres", "expected numbers that rise");
    }
    keys.reject_unknown_keys();
    std::copy(bases.begin(), bases.end(), set.bases);
    return set;
}

void read_labels(TomlTable &keys, int *out) {
    const double count = static_cast<double>(static_cast<int>(quiesce_stf_labels));
    const std::vector<double> labels = keys.numbers("rules", quiesce_stf_rules);
    for (std::size_t r = 0; r < labels.size(); ++r) {
        if (!(labels[r] >= 0.0 && labels[r] < count &&
              labels[r] == static_cast<double>(static_cast<int>(labels[r])))) {
            keys.fail("rules", "expected 25 integers in 0 .. 4, the output's label of each rule");
        }
        out[r] = static_cast<int>(labels[r]);
    }
}

FuzzyCluster read_cluster(TomlTable &table, std::size_t inputs) {
    FuzzyCluster cluster;
    cluster.centre = table.numbers("centre", inputs);
    cluster.width = positive_numbers(table, "width", inputs);
    cluster.gain_N = table.numbers("gain_N", inputs);
    cluster.offset_N = table.number("offset_N", {-1e12, 1e12, "N"});
    table.reject_unknown_keys();
    return cluster;
}

void refuse_temperature(TomlTable &keys) {
    if (keys.has("temperature_C")) {
        keys.fail("temperature_C", "a network with delays has no temperature; drop this table");
    }
}

quiesce_quadrature read_quadrature(TomlTable keys) {
    quiesce_quadrature params{};
    params.window_s = keys.number("window_s", {1e-6, 1e6, "s"});
    params.envelope_m = keys.number("envelope_m", {1e-9, 100.0, "m"});
    params.lowest_rad_s = keys.number("lowest_rad_s", {1e-9, 1e6, "rad/s"});
    params.highest_rad_s = keys.number("highest_rad_s", {1e-9, 1e6, "rad/s"});
    if (!(params.highest_rad_s > params.lowest_rad_s)) {
        keys.fail("highest_rad_s", "expected more than lowest_rad_s");
    }
    keys.reject_unknown_keys();
    return params;
}

enum class Memory { lags, feedback, quadrature };

std::shared_ptr<const Damper> read_sampled(TomlTable &keys, const LearnedContext &context,
                                           Memory memory) {
    SampledNetworkParams params{};
    refuse_temperature(keys);
    params.stroke_m = context.limits.stroke_m;
    params.sample_time_s = keys.number("sample_time_s", {1e-6, 10.0, "s"});
    params.force_scale_N = read_force_scale_N(keys);
    params.lags = rising_integers(keys, "lags", 0, kMostLag);
    if (memory == Memory::quadrature) {
        params.quadrature = read_quadrature(keys.table("quadrature"));
    }
    if (memory == Memory::feedback) {
        params.feedback = rising_integers(keys, "feedback", 1, kMostLag);
    }
    InputBox box = read_inputs(keys);
    const std::size_t width = box.count() + (params.quadrature ? quiesce_quadrature_features : 0);
    const std::size_t inputs = params.lags.size() * width + params.feedback.size();
    Network network = read_network(keys, inputs, 1);
    return std::make_shared<SampledNetwork>(std::move(box), std::move(params), std::move(network));
}

std::shared_ptr<const Damper> read_anfis(TomlTable &keys, const LearnedContext &context) {
    std::vector<GaussianSet> sets;
    InputBox box =
        read_inputs(keys, [&sets](TomlTable &input) { sets.push_back(read_gaussians(input)); });
    std::size_t rules = 1;
    for (const GaussianSet &set : sets) {
        rules *= std::min(set.centres.size(), kMostItems);
        if (rules > kMostItems) {
            keys.fail("consequents_N", "more than " + std::to_string(kMostItems) + " rules");
        }
    }
    std::vector<double> consequents_N = keys.numbers("consequents_N", rules);
    return std::make_shared<Anfis>(std::move(box), context.limits.stroke_m, sets,
                                   std::move(consequents_N));
}

std::shared_ptr<const Damper> read_ts_fuzzy(TomlTable &keys, const LearnedContext &context) {
    InputBox box = read_inputs(keys);
    std::vector<FuzzyCluster> clusters;
    for (TomlTable &table : keys.tables("rule")) {
        clusters.push_back(read_cluster(table, box.count()));
    }
    if (clusters.empty()) {
        keys.fail("rule", "missing; expected tables [[...rule]] with centre, width, gain_N and "
                          "offset_N");
    }
    return std::make_shared<TsFuzzy>(std::move(box), context.limits.stroke_m, clusters);
}

std::shared_ptr<const Damper> read_neuro_fuzzy_stf(TomlTable &keys, const LearnedContext &context) {
    StfParams params{};
    params.force_scale_N = read_force_scale_N(keys);
    params.disp_scale_m = keys.number("disp_scale_m", {1e-9, 100.0, "m"});
    params.velocity_scale_m_s = keys.number("velocity_scale_m_s", {1e-9, 1000.0, "m/s"});
    params.current_scale_A = keys.number("current_scale_A", {1e-9, 1000.0, "A"});
    params.uses_minimum = keys.choice("conjunction", {"product", "minimum"}) == "minimum" ? 1 : 0;
    params.disp = read_triangles(keys.table("displacement"));
    params.velocity = read_triangles(keys.table("velocity"));
    params.current = read_triangles(keys.table("current"));
    read_five(keys, "outputs", params.outputs);
    read_five(keys, "gains", params.gains);
    read_labels(keys, params.labels);
    return std::make_shared<NeuroFuzzyStf>(params, context.limits.stroke_m);
}

std::shared_ptr<const Damper> read_feed_forward_network(TomlTable &keys,
                                                        const LearnedContext &context) {
    if (keys.has("lags")) {
        return read_sampled(keys, context, Memory::lags);
    }
    const double force_scale_N = read_force_scale_N(keys);
    InputBox box = read_inputs(keys);
    Network network = read_network(keys, box.count(), 1);
    return std::make_shared<StaticNetwork>(std::move(box), context.limits.stroke_m,
                                           std::move(network), force_scale_N);
}

std::shared_ptr<const Damper> read_recurrent_network(TomlTable &keys,
                                                     const LearnedContext &context) {
    return read_sampled(keys, context, Memory::feedback);
}

std::shared_ptr<const Damper> read_hilbert_network(TomlTable &keys, const LearnedContext &context) {
    return read_sampled(keys, context, Memory::quadrature);
}

std::shared_ptr<const Damper> read_support_vector(TomlTable &keys, const LearnedContext &context) {
    SupportVectorParams params{};
    params.force_scale_N = read_force_scale_N(keys);
    params.gamma = keys.number("gamma", {1e-9, 1e9, "-"});
    params.intercept = keys.number("intercept", {-1e12, 1e12, "of force_scale_N"});
    params.coefficients = keys.numbers("coefficients", 0);
    InputBox box = read_inputs(keys);
    params.support_vectors =
        keys.numbers("support_vectors", params.coefficients.size() * box.count());
    return std::make_shared<SupportVector>(std::move(box), context.limits.stroke_m,
                                           std::move(params));
}

/// Null where there is none.
std::shared_ptr<const Damper> read_base(TomlTable &keys, ReadDamper read_damper) {
    std::optional<TomlTable> section = keys.optional_table("base");
    if (!section) {
        return nullptr;
    }
    std::shared_ptr<const Damper> base = read_damper(*section);
    section->reject_unknown_keys();
    if (base->is_sampled()) {
        keys.fail("base", "a model with a sample time of its own cannot be a base");
    }
    return base;
}

std::shared_ptr<const Damper> read_hysteresis_network(TomlTable &keys,
                                                      const LearnedContext &context) {
    HysteresisNetworkParams params{};
    params.stroke_m = context.limits.stroke_m;
    params.speed_m_s = context.limits.speed_m_s;
    params.force_scale_N = read_force_scale_N(keys);
    params.current_scale_A = keys.number("current_scale_A", {1e-9, 1000.0, "A"});
    params.field_exponent = keys.number("field_exponent", {0.1, 10.0, "-"}, 1.0);
    params.saturation = keys.number("saturation", {1e-3, 1e12, "-"}, 1e12);
    params.uses_accel = keys.boolean("uses_accel", false);
    params.coil_times_s = optional_positive_numbers(keys, "coil_times_s");
    params.coil_fall_times_s =
        keys.has("coil_fall_times_s")
            ? positive_numbers(keys, "coil_fall_times_s", params.coil_times_s.size())
            : params.coil_times_s;
    params.elastic_times_s = optional_positive_numbers(keys, "elastic_times_s");
    params.chain_times_s = optional_positive_numbers(keys, "chain_times_s");
    params.stop_reaches_m = optional_positive_numbers(keys, "stop_reaches_m");
    params.base = read_base(keys, context.read_damper);
    const std::size_t features = feature_count(params);
    params.means = keys.numbers("feature_means", features);
    params.scales = positive_numbers(keys, "feature_scales", features);
    params.clip = keys.number("clip", {0.1, 1000.0, "of feature_scales"});
    const auto heads = static_cast<std::size_t>(keys.integer("field_order", 0, 4) + 1);
    params.skip = keys.numbers("skip", heads * features);
    std::vector<Network> members;
    for (TomlTable &member : keys.tables("member")) {
        members.push_back(read_network(member, features, heads));
        member.reject_unknown_keys();
    }
    if (members.empty()) {
        keys.fail("member", "missing; expected tables [[...member]] with layers");
    }
    return std::make_shared<HysteresisNetwork>(std::move(params), std::move(members));
}

} // namespace

const std::vector<LearnedModel> &learned_models() {
    static const std::vector<LearnedModel> models = {
        {"anfis", read_anfis},
        {"feed_forward_network", read_feed_forward_network},
        {"hilbert_network", read_hilbert_network},
        {"hysteresis_network", read_hysteresis_network},
        {"neuro_fuzzy_stf", read_neuro_fuzzy_stf},
        {"recurrent_network", read_recurrent_network},
        {"support_vector", read_support_vector},
        {"ts_fuzzy", read_ts_fuzzy},
    };
    return models;
}

} // namespace quiesce
