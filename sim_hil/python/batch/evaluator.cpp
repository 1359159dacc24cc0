#include "evaluator.h"

#include <algorithm>
#include <functional>

#include "input_error.h"
#include "kernels.h"
#include "run_group.h"
#include "wide_sets.h"

namespace quiesce {

template <>
struct LaneAccess<double> {
    static double load(const double *values, std::size_t index) { return values[index]; }
    static void store(double *values, std::size_t row, double value) { values[row] = value; }
};

namespace {

template <class Kernel>
void run_one(const GroupJob &job) {
    GroupRun<Kernel, double>{job}();
}

#define QUIESCE_FUNCTION(Kernel) run_one<Kernel>,
const GroupFunction kScalarFunctions[] = {QUIESCE_KERNELS(QUIESCE_FUNCTION)};
#undef QUIESCE_FUNCTION

#define QUIESCE_COUNT(Kernel) Kernel::kParameters.size(),
const std::size_t kParameterCounts[] = {QUIESCE_KERNELS(QUIESCE_COUNT)};
#undef QUIESCE_COUNT

std::vector<GroupTable> usable_sets() {
    std::vector<GroupTable> sets = wide_sets();
    sets.push_back({kScalarFunctions, 1, "scalar"});
    return sets;
}

GroupTable find_set(const std::string &name) {
    for (const GroupTable &set : usable_sets()) {
        if (name == set.name) {
            return set;
        }
    }
    throw InputError("no set of instructions '" + name + "' on this processor");
}

bool has_current_law(const CandidateRows &candidates) {
    const std::size_t parameters = kParameterCounts[candidates.model];
    return std::any_of(candidates.orders, candidates.orders + parameters,
                       [](int order) { return order > 1; });
}

bool has_field_law(const CandidateRows &candidates) {
    const std::size_t length = row_length(candidates.model, candidates.orders);
    bool found = false;
    for (std::size_t row = 0; row < candidates.count; ++row) {
        const double *rig = candidates.rows + (row + 1) * length - kRigCount;
        found = found || rig[kRigFieldExponent] > 0.0;
    }
    return found;
}

/// Samples that are sorted by candidate at once: a group's rows of that many stay in the cache.
constexpr std::size_t kBlock = 16;

/// Rows first, first + 1, ... side by side; lanes beyond the last row repeat it.
void lay_out(const CandidateRows &candidates, std::size_t first, std::size_t lanes,
             std::vector<double> &coefficients, std::vector<double> &rig) {
    const std::size_t parameters = kParameterCounts[candidates.model];
    const std::size_t length = row_length(candidates.model, candidates.orders);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t row = std::min(first + lane, candidates.count - 1);
        const double *values = candidates.rows + row * length;
        for (std::size_t k = 0; k < parameters; ++k) {
            for (int c = 0; c < candidates.orders[k]; ++c) {
                const std::size_t slot = k * kMaxCoefficients + static_cast<std::size_t>(c);
                coefficients[slot * lanes + lane] = *values++;
            }
        }
        for (std::size_t k = 0; k < kRigCount; ++k) {
            rig[k * lanes + lane] = *values++;
        }
    }
}

/// Calls done(first row, lanes, forces [samples][lanes]) for group after group.
void for_groups(
    const CandidateRows &candidates, const MotionGrid &motion, const std::string &set_name,
    const std::function<void(std::size_t, std::size_t, const std::vector<double> &)> &done) {
    const GroupTable set = find_set(set_name);
    const std::size_t lanes = set.lanes;
    const std::size_t parameters = kParameterCounts[candidates.model];
    std::vector<double> coefficients(parameters * kMaxCoefficients * lanes, 0.0);
    std::vector<double> rig(kRigCount * lanes, 0.0);
    std::vector<double> force_N(motion.samples() * lanes);
    for (std::size_t first = 0; first < candidates.count; first += lanes) {
        lay_out(candidates, first, lanes, coefficients, rig);
        const GroupJob job{&motion,
                           coefficients.data(),
                           rig.data(),
                           has_current_law(candidates),
                           has_field_law(candidates),
                           force_N.data()};
        set.functions[candidates.model](job);
        done(first, std::min(lanes, candidates.count - first), force_N);
    }
}

/// Candidates `used` of a group in the order of time, side by side: the rows of memory are read
/// once. The same sums as one candidate after the other, bit for bit.
void squared_errors_of(const std::vector<double> &group, std::size_t lanes, std::size_t used,
                       const Measured &measured, double *error_N2) {
    std::fill(error_N2, error_N2 + used, 0.0);
    for (std::size_t k = 0; k * lanes < group.size(); ++k) {
        const double weight = measured.weight == nullptr ? 1.0 : measured.weight[k];
        const double *row = group.data() + k * lanes;
        for (std::size_t lane = 0; lane < used; ++lane) {
            const double error_N = row[lane] - measured.force_N[k];
            error_N2[lane] += weight * error_N * error_N;
        }
    }
}

double squared_error_of(const std::vector<double> &force_N, const Measured &measured) {
    double sum = 0.0;
    for (std::size_t k = 0; k < force_N.size(); ++k) {
        const double error_N = force_N[k] - measured.force_N[k];
        sum += (measured.weight == nullptr ? 1.0 : measured.weight[k]) * error_N * error_N;
    }
    return sum;
}

} // namespace

std::size_t row_length(std::size_t model, const int *orders) {
    std::size_t length = kRigCount;
    for (std::size_t k = 0; k < kParameterCounts[model]; ++k) {
        length += static_cast<std::size_t>(orders[k]);
    }
    return length;
}

std::string set_for(std::size_t count) {
    const std::vector<GroupTable> sets = usable_sets();
    const auto fits = [count](const GroupTable &set) { return set.lanes >= count; };
    const auto narrowest = std::find_if(sets.rbegin(), sets.rend(), fits);
    return narrowest == sets.rend() ? sets.front().name : narrowest->name;
}

std::vector<std::string> instruction_sets() {
    std::vector<std::string> names;
    for (const GroupTable &set : usable_sets()) {
        names.emplace_back(set.name);
    }
    return names;
}

void simulate(const CandidateRows &candidates, const MotionGrid &motion, const std::string &set,
              double *force_N) {
    const std::size_t samples = motion.samples();
    for_groups(candidates, motion, set,
               [&](std::size_t first, std::size_t used, const std::vector<double> &group) {
                   const std::size_t lanes = group.size() / samples;
                   for (std::size_t start = 0; start < samples; start += kBlock) {
                       const std::size_t end = std::min(start + kBlock, samples);
                       for (std::size_t lane = 0; lane < used; ++lane) {
                           double *out = force_N + (first + lane) * samples;
                           for (std::size_t k = start; k < end; ++k) {
                               out[k] = group[k * lanes + lane];
                           }
                       }
                   }
               });
}

void squared_error(const CandidateRows &candidates, const MotionGrid &motion,
                   const Measured &measured, const std::string &set, double *error_N2) {
    const std::size_t samples = motion.samples();
    std::vector<double> one(samples);
    for_groups(candidates, motion, set,
               [&](std::size_t first, std::size_t used, const std::vector<double> &group) {
                   const std::size_t lanes = group.size() / samples;
                   if (measured.average_samples <= 1) {
                       squared_errors_of(group, lanes, used, measured, error_N2 + first);
                       return;
                   }
                   for (std::size_t lane = 0; lane < used; ++lane) {
                       for (std::size_t k = 0; k < samples; ++k) {
                           one[k] = group[k * lanes + lane];
                       }
                       moving_average(one, measured.average_samples);
                       error_N2[first + lane] = squared_error_of(one, measured);
                   }
               });
}

void moving_average(std::vector<double> &values, std::size_t samples) {
    if (samples <= 1) {
        return;
    }
    std::vector<double> sums(values.size() + 1, 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) {
        sums[k + 1] = sums[k] + values[k];
    }
    const std::size_t half = samples / 2;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const std::size_t reach = std::min({half, k, values.size() - 1 - k});
        values[k] = (sums[k + reach + 1] - sums[k - reach]) / static_cast<double>(2 * reach + 1);
    }
}

} // namespace quiesce
