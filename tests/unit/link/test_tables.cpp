/// Tables on every target: the same bits as on the host, the same refusals.
#include <cmath>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include "bench_call.h"
#include "can_link.h"
#include "comparing_link.h"
#include "descriptor_stream.h"
#include "images.h"
#include "in_process_link.h"
#include "lockstep_peer.h"
#include "qemu_shm_link.h"
#include "qemu_uart_link.h"
#include "slcan_channel.h"
#include "table_files.h"

extern "C" {
#include "plant_pulses.h"
}

#include "plant_rules.h"

namespace quiesce {
namespace {

constexpr TelemetryRate kSparse{100, QUIESCE_CAN_TELEMETRY_WORDS};

/// A target, with what drives it. Size of its build: for one sensor and damper, or for all.
struct Driven {
    std::unique_ptr<LockstepPeer> peer;
    std::unique_ptr<ControllerLink> link;
};

Driven over_a_line() {
    auto ends = socket_pair(SOCK_STREAM);
    CanLinkOptions options;
    options.telemetry = kSparse;
    auto stream = std::make_unique<DescriptorStream>(std::move(ends.first), "line");
    return {std::make_unique<LockstepPeer>(std::move(ends.second)),
            std::make_unique<CanLink>(make_slcan_channel(std::move(stream), 0), options)};
}

struct TargetKind {
    const char *name;
    Driven (*make)(bool is_large);
};

const TargetKind kTargets[] = {
    {"mps2",
     [](bool is_large) {
         const std::string &image = is_large ? kLargestImage : kShmImage;
         return Driven{nullptr, std::make_unique<QemuShmLink>(uncounted(image))};
     }},
    {"mps2_uart",
     [](bool is_large) {
         const std::string &image = is_large ? kLargestUartImage : kUartImage;
         return Driven{nullptr, std::make_unique<QemuUartLink>(uncounted(image), kSparse)};
     }},
    {"linux", [](bool) { return over_a_line(); }},
};

class TablesOn : public testing::TestWithParam<TargetKind> {};

void PrintTo(const TargetKind &kind, std::ostream *out) {
    *out << kind.name;
}

INSTANTIATE_TEST_SUITE_P(link, TablesOn, testing::ValuesIn(kTargets),
                         [](const auto &kind) { return std::string(kind.param.name); });

struct Case {
    quiesce_params_t params = default_params();
    bool has_board = false;
    Tables tables;
};

/// The rules that ship, with 1.5 A more everywhere.
Case rules() {
    constexpr std::size_t kOutput = 9, kOrigin = 14, kOutputOrigin = 2;
    Words words(std::begin(plant_rules_table), std::end(plant_rules_table));
    words[kOrigin] += 1500;
    words[words[kOutput] + kOutputOrigin] += 1500;
    Case out;
    out.params.law = QUIESCE_LAW_FUZZY;
    out.params.max_current_mA = 10000;
    out.tables[LOCKSTEP_LAW_TABLE] = with_crc(words);
    return out;
}

/// The pulses that ship, of 3 A and nothing between them.
Case pulses() {
    constexpr std::size_t kPoints = 5, kPointWords = 4;
    Words words(std::begin(plant_pulses_table), std::end(plant_pulses_table));
    for (std::size_t i = kPoints; i < words.size(); i += kPointWords) {
        words[i] = (words[i] & 0xFFFFu) | 3000u << 16;
        words[i + 2] &= 0xFFFF0000u;
    }
    Case out;
    out.params.law = QUIESCE_LAW_PHASE;
    out.tables[LOCKSTEP_LAW_TABLE] = with_crc(words);
    return out;
}

/// Friction of a damper, and the map of it, over the velocity of its stroke.
Case friction() {
    Case out;
    out.params.law = QUIESCE_LAW_FRICTION;
    out.params.tracker = QUIESCE_TRACKER_INVERSE;
    out.has_board = true;
    out.tables[LOCKSTEP_LAW_TABLE] =
        with_crc({0x31524651u, 0, 9, 1, 500000, 1000, 30000000, 200, 3});
    constexpr auto kLow = static_cast<std::uint32_t>(-1000000);
    out.tables[LOCKSTEP_TRACKER_TABLE] = with_crc(
        {0x32464D51u, 0, 15, 1, 4, 2, 2, kLow, 1000000, 0, 2000, 0xFFFFFFFFu, kLow, 1, 1000000});
    return out;
}

/// 12 Hz everywhere, and some noise.
lockstep_stimulus_t sine(std::uint32_t tick) {
    constexpr double kTwoPi = 6.283185307179586;
    lockstep_stimulus_t out{tick > 0 ? LOCKSTEP_ENABLE : 0u, {0}, {0}};
    for (std::uint32_t i = 0; i < QUIESCE_MAX_SENSORS; ++i) {
        const double phase = kTwoPi * 0.012 * tick + 0.1 * i;
        const auto noise = static_cast<std::int32_t>((tick * 2654435761u) >> 20) % 201 - 100;
        out.counts[i] = noise + static_cast<std::int32_t>(std::lround(20000.0 * std::sin(phase)));
        out.flags |= LOCKSTEP_FRESH << i;
    }
    return out;
}

/// As long as a law takes to act.
constexpr std::uint32_t kTicks = 1500;

/// Strokes of millimetres; no driver says what flows, as nothing here would follow the commands.
quiesce_board_t moved_board() {
    quiesce_board_t board = largest_board();
    for (quiesce_board_sensor_t &sensor : board.sensor) {
        sensor.scale = sensor.sense == QUIESCE_SENSE_STROKE ? 100000 : sensor.scale;
    }
    for (quiesce_board_damper_t &damper : board.damper) {
        damper.measures_current = 0;
    }
    return board;
}

/// What is commanded, a sum over so many ticks.
std::uint64_t commanded(ControllerLink &link, const Case &wanted, const Tables &tables,
                        std::uint32_t ticks = kTicks) {
    const quiesce_board_t board = moved_board();
    const StartAnswer answer =
        link.start(wanted.has_board ? &board : nullptr, wanted.params, tables);
    EXPECT_TRUE(answer) << answer.table.verdict;
    std::uint64_t sum = 0;
    for (std::uint32_t tick = 0; tick < ticks; ++tick) {
        lockstep_reply_t reply;
        link.exchange(sine(tick), reply);
        sum += static_cast<std::uint64_t>(reply.current_cmd_mA[0]);
    }
    return sum;
}

/// With its tables, then with none: each word that the target sends is the host's.
void expect_tables_in_use(ControllerLink &target, const Case &wanted) {
    InProcessLink host, beside;
    ComparingLink link(host, target);
    const std::uint64_t with = commanded(link, wanted, wanted.tables);
    EXPECT_NE(with, commanded(beside, wanted, {}));
    commanded(link, wanted, {}, kTicks / 10);
    EXPECT_EQ(link.mismatches(), 0u);
}

TEST_P(TablesOn, rules_answer_like_the_host) {
    const Driven target = GetParam().make(false);
    expect_tables_in_use(*target.link, rules());
}

TEST_P(TablesOn, pulses_answer_like_the_host) {
    const Driven target = GetParam().make(false);
    expect_tables_in_use(*target.link, pulses());
}

TEST_P(TablesOn, a_laws_table_and_its_map_answer_like_the_host) {
    const Driven target = GetParam().make(true);
    expect_tables_in_use(*target.link, friction());
}

TEST_P(TablesOn, the_longest_table_gets_there) {
    Case wanted = rules();
    const Tables tables = wanted.tables;
    Words &words = wanted.tables[LOCKSTEP_LAW_TABLE];
    words.resize(QUIESCE_TABLE_WORDS, 0xA5A5A5A5u); // that no rule names
    words[2] = QUIESCE_TABLE_WORDS;
    words = with_crc(words);
    const Driven target = GetParam().make(false);
    InProcessLink host;
    constexpr std::uint32_t kFew = 300;
    EXPECT_EQ(commanded(*target.link, wanted, wanted.tables, kFew),
              commanded(host, wanted, tables, kFew));
}

struct Damaged {
    std::uint32_t table;
    quiesce_table_verdict_t verdict;
    Tables tables;
};

/// Wrong checksum, wrong kind, cut, too long; of the law's and of the tracker's.
std::vector<Damaged> damaged() {
    const Tables good = friction().tables;
    std::vector<Damaged> out;
    for (std::uint32_t i = 0; i < LOCKSTEP_TABLES; ++i) {
        const auto add = [&](quiesce_table_verdict_t verdict, const auto &change) {
            out.push_back({i, verdict, good});
            change(out.back().tables[i]);
        };
        add(QUIESCE_TABLE_CRC, [](Words &words) { words[4] ^= 1u; });
        add(QUIESCE_TABLE_MAGIC, [](Words &words) { words = rules().tables[0]; });
        add(QUIESCE_TABLE_SIZE, [](Words &words) { words.pop_back(); });
        add(QUIESCE_TABLE_SIZE, [](Words &words) { words.resize(QUIESCE_TABLE_WORDS + 1); });
    }
    return out;
}

TEST_P(TablesOn, what_is_refused_is_named_and_runs_nothing) {
    const quiesce_board_t board = moved_board();
    const Driven target = GetParam().make(true);
    InProcessLink host;
    ComparingLink link(host, *target.link);
    for (const Damaged &one : damaged()) {
        const StartAnswer answer = link.start(&board, friction().params, one.tables);
        EXPECT_FALSE(answer);
        EXPECT_EQ(answer.table.verdict, std::uint32_t{one.verdict});
        EXPECT_EQ(answer.table.table, one.table);
        lockstep_reply_t reply;
        for (std::uint32_t tick = 0; tick < 20; ++tick) {
            link.exchange(sine(tick), reply);
        }
        EXPECT_EQ(reply.telemetry.fault, std::uint32_t{QUIESCE_FAULT_PARAMETER});
        EXPECT_EQ(reply.drivers_enabled, 0u);
    }
    EXPECT_EQ(link.mismatches(), 0u);
    EXPECT_TRUE(link.start(&board, friction().params, friction().tables));
}

/// What a run's every reply adds up to.
std::string digest_of(const std::string &options) {
    const Outcome outcome =
        bench("run --scenario sim_hil/data/rigs/two_storeys.toml --law friction "
              "--set tracker=inverse " +
              options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return nlohmann::json::parse(outcome.output)["telemetry_crc32"].dump();
}

TEST(table_options, give_every_target_the_hosts_bits) {
    const Tables tables = friction().tables;
    const TempFile law(tables[LOCKSTEP_LAW_TABLE]), map(tables[LOCKSTEP_TRACKER_TABLE]);
    const std::string options = "--law-table " + law.name() + " --force-map " + map.name();
    const std::string host = digest_of(options);
    EXPECT_EQ(digest_of(options + " --target mps2 --image " + kLargestImage), host);
    Pty pty = make_pty();
    const FileDescriptor held_open(open(pty.path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    const LockstepPeer peer(std::move(pty.master));
    EXPECT_EQ(digest_of(options + " --target linux --telemetry-every 500 --can slcan:" + pty.path),
              host);
}

TEST(table_options, go_with_run_and_compare) {
    const TempFile table(pulses().tables[LOCKSTEP_LAW_TABLE]);
    const std::string run =
        "--scenario sim_hil/data/scenarios/sine_5Hz.toml --law phase --pulses " + table.name() +
        " --target mps2 --image " + kShmImage;
    EXPECT_EQ(bench("run " + run).exit_code, 0);
    const Outcome compared = bench("compare --seeds 1 " + run);
    EXPECT_EQ(nlohmann::json::parse(compared.output)["mismatches"], 0) << compared.output;
}

TEST(tables_over_can, a_refusal_of_no_table_is_refused) {
    auto ends = socket_pair(SOCK_STREAM);
    const LockstepPeer peer(
        std::move(ends.second), [](const can_frame_t &, std::vector<can_frame_t> &replies) {
            if (!replies.empty() && replies[0].id == QUIESCE_CAN_LOCKSTEP_STATUS_FRAME_ID) {
                replies[0].data[0] |= 0x30; // verdict
                replies[0].data[1] = LOCKSTEP_TABLES;
            }
            return std::optional<std::string>("");
        });
    CanLink link(
        make_slcan_channel(std::make_unique<DescriptorStream>(std::move(ends.first), "line"), 0),
        {});
    EXPECT_EQ(error_of([&] { link.start(nullptr, default_params(), rules().tables); }),
              "line: refuses a table that there is not; rebuild it");
}

} // namespace
} // namespace quiesce
