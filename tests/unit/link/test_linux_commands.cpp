/// run and compare with --target linux, as a user meets them, with the lock-step server on a pty.
#include <fcntl.h>
#include <nlohmann/json.hpp>

#include "bench_call.h"
#include "images.h"
#include "lockstep_peer.h"

namespace quiesce {
namespace {

const std::string kScenario = "--scenario sim_hil/data/scenarios/trace_equality.toml --law fuzzy ";

/// A server on a pty for as many benches as come.
struct Target {
    explicit Target(Tamper tamper = {})
        : pty(make_pty()), held_open(open(pty.path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)),
          options("--target linux --can slcan:" + pty.path + " "),
          peer(std::move(pty.master), std::move(tamper)) {}

    Pty pty;
    FileDescriptor held_open;
    std::string options;
    LockstepPeer peer;
};

nlohmann::json json_of(const std::string &words) {
    const Outcome outcome = bench(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return nlohmann::json::parse(outcome.output);
}

TEST(linux_target, compare_finds_every_word_equal) {
    const Target target;
    const auto json = json_of("compare " + kScenario + "--seeds 1 " + target.options);
    EXPECT_EQ(json["mismatches"], 0) << json;
    EXPECT_EQ(json["targets"], nlohmann::json({"host", "linux"}));
    EXPECT_EQ(json["compared_words"], json["ticks"].get<std::size_t>() * kWordsOverCan);
    EXPECT_FALSE(json["faults_seen"].empty());
    EXPECT_TRUE(json["instr_median"].is_null());
}

TEST(linux_target, compare_with_less_telemetry_counts_what_it_compared) {
    const Target target;
    const auto json =
        json_of("compare " + kScenario + "--seeds 1,2 --telemetry-every 100 " + target.options);
    const std::size_t ticks = json["ticks"];
    EXPECT_EQ(json["mismatches"], 0) << json;
    EXPECT_EQ(json["compared_words"], ticks / 100 * (99 * kCommandWords + kWordsOverCan));
}

TEST(linux_target, run_equals_the_host_with_any_telemetry) {
    const Target target;
    auto host = json_of("run " + kScenario);
    for (const char *telemetry : {"", "--telemetry-every 100 "}) {
        auto linux = json_of("run " + kScenario + telemetry + target.options);
        EXPECT_EQ(linux["mismatches"], *telemetry == '\0' ? nlohmann::json() : nlohmann::json(0));
        for (const char *own : {"target", "wall_s", "realtime_factor", "mismatches"}) {
            linux.erase(own);
            host.erase(own);
        }
        EXPECT_EQ(linux, host);
    }
}

TEST(linux_target, wrong_bit_is_reported) {
    const Target target([](const can_frame_t &request, std::vector<can_frame_t> &replies) {
        if (request.id == QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID && replies.size() > 1) {
            replies[0].data[0] ^= 1u;
        }
        return std::optional<std::string>("");
    });
    const auto compared =
        json_of("compare " + kScenario + "--seeds 1 --telemetry-every 1000 " + target.options);
    EXPECT_EQ(compared["mismatches"], compared["ticks"].get<int>() / 1000);
    EXPECT_EQ(compared["first_mismatch"]["field"], "tick");
    EXPECT_EQ(compared["first_mismatch"]["tick"], 999);
    const auto run = json_of("run " + kScenario + "--telemetry-every 1000 " + target.options);
    EXPECT_EQ(run["mismatches"], compared["mismatches"]);
    EXPECT_NE(run["telemetry_crc32"], json_of("run " + kScenario)["telemetry_crc32"]);
}

/// A build of a board has not all that the bench's has.
TEST(linux_target, parameter_that_it_refuses_is_named) {
    const Target target([](const can_frame_t &request, std::vector<can_frame_t> &replies) {
        if (request.id == QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID) {
            quiesce_can_lockstep_status_t status{};
            (void)quiesce_can_lockstep_status_unpack(&status, replies[0].data, replies[0].length);
            status.param_is_refused = 1;
            status.refused_index = offsetof(quiesce_params_t, tracker) / sizeof(std::int32_t);
            (void)quiesce_can_lockstep_status_pack(replies[0].data, &status,
                                                   sizeof replies[0].data);
        }
        return std::optional<std::string>("");
    });
    const Outcome outcome = bench("run " + kScenario + target.options);
    EXPECT_EQ(outcome.exit_code, 2);
    expect_contains(outcome.output, "on target linux refuses tracker = 0: what it asks for");
}

struct BadCall {
    const char *name;
    std::string words;
    const char *message;
};

void PrintTo(const BadCall &call, std::ostream *out) {
    *out << call.name;
}

class BadLinuxCalls : public testing::TestWithParam<BadCall> {};

TEST_P(BadLinuxCalls, exit_with_2_and_one_line) {
    const Outcome outcome = bench("run " + kScenario + GetParam().words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.output.rfind("quiesce_bench: ", 0), 0u) << outcome.output;
    EXPECT_EQ(outcome.output.find('\n'), outcome.output.size() - 1) << outcome.output;
    expect_contains(outcome.output, GetParam().message);
}

const BadCall kBadCalls[] = {
    {"no_channel", "--target linux", "--target linux needs --can CHANNEL"},
    {"bad_channel", "--target linux --can can0", "--can can0: is no CAN channel"},
    {"image", "--target linux --can x --image y.elf", "--image: --target linux runs no image"},
    {"plugin", "--target linux --can x --plugin y.so", "--plugin: --target linux runs no image"},
    {"can_on_host", "--can slcan:/dev/ptmx", "--can: only --target linux is driven over"},
    {"can_on_image", "--target mps2 --can slcan:/dev/ptmx", "--can: only --target linux"},
    {"telemetry_on_host", "--telemetry-every 5", "--telemetry-every: only --target linux"},
    {"wait_on_host", "--wait-s 5", "--wait-s: only --target linux"},
    {"no_telemetry", "--target linux --can x --telemetry-every 0",
     "--telemetry-every 0: expected an integer in 1 .. 65535"},
    {"telemetry_word", "--target linux --can x --telemetry-every all", "--telemetry-every all: "},
    {"wait_word", "--target linux --can x --wait-s long", "--wait-s long: "},
    {"nobody_there", "--target linux --wait-s 0.2 --can slcan:/dev/ptmx",
     "slcan:/dev/ptmx: no target answers within 200 ms; is quiesced --lockstep running"},
};

INSTANTIATE_TEST_SUITE_P(link, BadLinuxCalls, testing::ValuesIn(kBadCalls),
                         [](const auto &call) { return call.param.name; });

} // namespace
} // namespace quiesce
