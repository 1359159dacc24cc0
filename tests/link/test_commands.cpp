/// compare and uart-rate as a user meets them.
#include <cstdio>
#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include "images.h"

namespace quiesce {
namespace {

struct Outcome {
    int exit_code;
    std::string output;
};

Outcome bench(const std::string &words, const std::string &environment = "") {
    const std::string command = environment + " " QUIESCE_BENCH " " + words + " 2>&1";
    std::FILE *pipe = popen(command.c_str(), "r");
    Outcome out{-1, ""};
    char buffer[4096];
    for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
        out.output.append(buffer, n);
    }
    out.exit_code = WEXITSTATUS(pclose(pipe));
    return out;
}

const std::string kScenario = "--scenario sim_hil/scenarios/trace_equality.toml --law fuzzy ";

TEST(compare, image_equals_the_host_bit_for_bit) {
    const Outcome outcome =
        bench("compare " + kScenario + "--seeds 1,2,3,4,5 --target mps2 --image " + kShmImage);
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
    const Outcome outcome =
        bench("uart-rate --exchanges 400 --image " + kUartImage + " --echo-image " + kEchoImage);
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
    {"wrong_plugin", "run " + kScenario + "--target mps2 --plugin no.so --image " + kShmImage,
     "plugin no.so: not found"},
    {"qemu_missing", "run " + kScenario + "--target mps2 --image " + kShmImage,
     "qemu-system-arm not found: install it", "PATH=/nonexistent"},
    {"no_seeds", "compare " + kScenario + "--target mps2 --image " + kShmImage,
     "--seeds is missing"},
    {"bad_seeds", "compare " + kScenario + "--seeds 1,x --target mps2 --image " + kShmImage,
     "--seeds 1,x: expected integers"},
    {"one_seed_option",
     "compare " + kScenario + "--seed 1 --seeds 1 --target mps2 --image " + kShmImage,
     "takes --seeds"},
    {"no_target", "compare " + kScenario + "--seeds 1", "--target is missing"},
    {"no_echo_image", "uart-rate --image " + kUartImage, "--echo-image is missing"},
    {"no_exchanges",
     "uart-rate --exchanges 1 --image " + kUartImage + " --echo-image " + kEchoImage,
     "--exchanges 1: expected an integer in 200"},
};

INSTANTIATE_TEST_SUITE_P(link, BadLinkCalls, testing::ValuesIn(kBadCalls),
                         [](const auto &call) { return call.param.name; });

} // namespace
} // namespace quiesce
