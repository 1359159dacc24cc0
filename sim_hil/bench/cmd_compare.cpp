/// compare: the same closed loop on the host and on a target, every word of every reply that the
/// target sends compared.
#include <iostream>
#include <sstream>

#include "commands.h"
#include "comparing_link.h"
#include "digest.h"
#include "in_process_link.h"
#include "input_error.h"
#include "json.h"
#include "run_options.h"

namespace quiesce {

namespace {

std::vector<std::uint64_t> parse_seeds(const std::string &list) {
    std::vector<std::uint64_t> seeds;
    std::istringstream words(list);
    for (std::string word; std::getline(words, word, ',');) {
        const auto seed = parse_integer(word);
        if (!seed || *seed < 0) {
            throw InputError("--seeds " + list + ": expected integers >= 0 with commas between");
        }
        seeds.push_back(static_cast<std::uint64_t>(*seed));
    }
    if (seeds.empty()) {
        throw InputError("--seeds: names no seed; try --seeds 1,2,3,4,5");
    }
    return seeds;
}

Json first_mismatch_json(const std::optional<FirstMismatch> &first,
                         const std::vector<std::uint64_t> &seeds) {
    if (!first) {
        return nullptr;
    }
    return {{"seed", seeds[first->run]}, {"tick", first->tick}, {"field", first->field}};
}

} // namespace

int cmd_compare(const std::vector<std::string> &words) {
    const Arguments arguments(
        "compare", words,
        options({run_option_names(), target_option_names(), table_option_names(), {"seeds"}}));
    arguments.require_no_positional();
    if (arguments.text("seed")) {
        throw InputError("compare: takes --seeds, a list, instead of --seed");
    }
    const std::vector<std::uint64_t> seeds = parse_seeds(arguments.required("seeds"));
    arguments.required("target");
    RunSetup setup = run_setup(arguments);
    setup.tables = tables_from(arguments, setup.board(), setup.params);
    // Instructions are those of the control step: a report is made for those who ask.
    setup.wants_report = !arguments.text("plugin").has_value();
    InProcessLink host;
    const std::unique_ptr<ControllerLink> target = target_link(arguments);
    ComparingLink link(host, *target);
    DigestObserver digest;
    std::int64_t ticks = 0;
    for (const std::uint64_t seed : seeds) {
        setup.seed = seed;
        ticks += run_scenario(setup, link, {&digest}).ticks;
    }
    const auto counts = link.finish();
    const Json out = {{"ticks", ticks},
                      {"mismatches", link.mismatches()},
                      {"compared_words", link.compared_words()},
                      {"first_mismatch", first_mismatch_json(link.first_mismatch(), seeds)},
                      {"distinct_commands", digest.distinct_commands()},
                      {"seeds", seeds},
                      {"targets", std::vector<std::string>{host.target(), target->target()}},
                      {"faults_seen", digest.faults_seen()},
                      {"instr_median", counts ? Json(counts->median) : Json()},
                      {"instr_worst", counts ? Json(counts->worst) : Json()}};
    std::cout << out.dump() << '\n';
    return 0;
}

} // namespace quiesce
