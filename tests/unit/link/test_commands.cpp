/// compare and uart-rate as a user meets them.
#include <nlohmann/json.hpp>

#include "bench_call.h"
#include "images.h"

namespace quiesce {
namespace {

const std::string kScenario = "--scenario sim_hil/data/scenarios/trace_equality.toml --law fuzzy ";

TEST(compare, image_equals_the_host_bit_for_bit) {
    const Outcome outcome = bench("compare " + kScenario +
                                  "--seeds 1,2,3,4,5 --target mps2 --image " + quoted(kShmImage));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const auto json = nlohmann::json::parse(outcome.output);
    EXPECT_EQ(json["mismatches"], 0) << outcome.output;
    EXPECT_TRUE(json["first_mismatch"].is_null());
    EXPECT_GE(json["ticks"], 10000);
    EXPECT_GE(json["distinct_commands"], 1000);
    EXPECT_EQ(json["seeds"].size(), 5u);
    EXPECT_EQ(json["targets"], nlohmann::json({"host", "mps2"}));
    EXPECT_FALSE(json["faults_seen"].empty());
    EXPECT_GE(json["instr_worst"], json["instr_median"]);
}

TEST(uart_rate, reports_both_rates) {
    const Outcome outcome = bench("uart-rate --exchanges 400 --image " + quoted(kUartImage) +
                                  " --echo-image " + quoted(kEchoImage));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const auto json = nlohmann::json::parse(outcome.output);
    EXPECT_EQ(json["exchanges"], 400);
    EXPECT_EQ(json["bytes_each_way"], 14.0);
    EXPECT_LE(json["reply_bytes"], 15.0);
    EXPECT_NEAR(json["ratio"].get<double>(),
                json["protocol_per_s"].get<double>() / json["echo_per_s"].get<double>(), 1e-9);
    EXPECT_GT(json["realtime_factor"], 0.0);
}

struct BadCall {
    const char *name;
    std::string words;
    const char *message;
    const char *environment = "";
};

void PrintTo(const BadCall &call, std::ostream *out) {
    *out << call.name;
}

class BadLinkCalls : public testing::TestWithParam<BadCall> {};

TEST_P(BadLinkCalls, exit_with_2_and_one_line) {
    const Outcome outcome = bench(GetParam().words, GetParam().environment);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.output.rfind("quiesce_bench: ", 0), 0u) << outcome.output;
    EXPECT_EQ(outcome.output.find('\n'), outcome.output.size() - 1) << outcome.output;
    expect_contains(outcome.output, GetParam().message);
}

const BadCall kBadCalls[] = {
    {"no_image", "run " + kScenario + "--target mps2", "needs --image ELF"},
    {"missing_image", "run " + kScenario + "--target mps2 --image no.elf", "image no.elf: cannot"},
    {"not_an_image", "run " + kScenario + "--target mps2 --image README.md", "is no 32-bit Arm"},
    {"wrong_plugin",
     "run " + kScenario + "--target mps2 --plugin no.so --image " + quoted(kShmImage),
     "plugin no.so: not found"},
    {"qemu_missing", "run " + kScenario + "--target mps2 --image " + quoted(kShmImage),
     "qemu-system-arm not found: install it", "PATH=/nonexistent"},
    {"no_seeds", "compare " + kScenario + "--target mps2 --image " + quoted(kShmImage),
     "--seeds is missing"},
    {"bad_seeds", "compare " + kScenario + "--seeds 1,x --target mps2 --image " + quoted(kShmImage),
     "--seeds 1,x: expected integers"},
    {"one_seed_option",
     "compare " + kScenario + "--seed 1 --seeds 1 --target mps2 --image " + quoted(kShmImage),
     "takes --seeds"},
    {"no_target", "compare " + kScenario + "--seeds 1", "--target is missing"},
    {"count_word", "count --word x --image " + quoted(kShmImage), "--word x: expected an integer"},
    {"count_negative_word", "count --word -1 --image " + quoted(kShmImage),
     "--word -1: expected an integer in 0..4294967295"},
    {"count_profile", "count --profile yes --image " + quoted(kShmImage),
     "--profile yes: expected off, all or the number of a pass"},
    {"count_unmarked", "count --image " + quoted(kEchoImage), "has no symbol quiesce_count_begin"},
    {"no_echo_image", "uart-rate --image " + quoted(kUartImage), "--echo-image is missing"},
    {"no_exchanges",
     "uart-rate --exchanges 1 --image " + quoted(kUartImage) + " --echo-image " +
         quoted(kEchoImage),
     "--exchanges 1: expected an integer in 200"},
};

INSTANTIATE_TEST_SUITE_P(link, BadLinkCalls, testing::ValuesIn(kBadCalls),
                         [](const auto &call) { return call.param.name; });

} // namespace
} // namespace quiesce
