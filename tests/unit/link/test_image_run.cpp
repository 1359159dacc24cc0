/// Images that run by themselves: counts against known numbers of instructions.
#include <filesystem>
#include <fstream>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "bench_call.h"
#include "image_run.h"
#include "images.h"

namespace quiesce {
namespace {

const std::string kCountProbe = QUIESCE_IMAGES "/../../tests/unit/mps2/count_probe.elf";

/// The call and the return; two instructions a turn. The probe's last call has five.
constexpr std::uint64_t kCall = 2;
constexpr std::uint64_t kDig = 5;

QemuOptions profiled(const std::string &profile) {
    QemuOptions options = options_for(kCountProbe);
    options.profile = profile;
    return options;
}

std::pair<std::uint64_t, std::uint64_t> sum_and_most(const ImageRun &run) {
    std::pair<std::uint64_t, std::uint64_t> out{0, 0};
    for (const auto &[address, count] : run.profile) {
        out.first += count;
        out.second = std::max(out.second, count);
    }
    return out;
}

TEST(image_run, counts_of_known_loops_are_exact) {
    const ImageRun run = run_image(options_for(kCountProbe), {9, 1000});
    EXPECT_EQ(run.counts.ticks, 10u);
    EXPECT_EQ(run.counts.worst, kCall + 2 * 1008);
    EXPECT_EQ(run.counts.median, kCall + 2 * 1003); // the fifth of ten
    EXPECT_EQ(run.counts.total, 9 * kCall + 2 * (9 * 1000 + 36) + kDig);
    EXPECT_TRUE(run.profile.empty());
}

TEST(image_run, whole_blocks_give_the_count_of_single_instructions) {
    QemuOptions each = options_for(kCountProbe);
    each.count_each_instruction = true;
    const InstructionCounts by_block = run_image(options_for(kCountProbe), {5, 70}).counts;
    const InstructionCounts by_instruction = run_image(each, {5, 70}).counts;
    EXPECT_EQ(by_block.total, by_instruction.total);
    EXPECT_EQ(by_block.worst, by_instruction.worst);
}

TEST(image_run, profile_sums_to_the_total) {
    const ImageRun run = run_image(profiled("all"), {4, 50});
    const auto [sum, most] = sum_and_most(run);
    EXPECT_EQ(sum, run.counts.total);
    EXPECT_EQ(run.counts.total, 4 * kCall + 2 * (4 * 50 + 6) + kDig);
    // Every turn of the loop begins the same block.
    EXPECT_EQ(most, 2u * (4 * 50 + 6));
}

TEST(image_run, profile_of_one_pass_sums_to_its_count) {
    const ImageRun run = run_image(profiled("2"), {4, 50});
    const auto [sum, most] = sum_and_most(run);
    EXPECT_EQ(sum, kCall + 2 * 51);
    EXPECT_EQ(most, 2u * 51);
    EXPECT_EQ(run.counts.worst_tick, 4u);
    EXPECT_EQ(sum_and_most(run_image(profiled("4"), {4, 50})).first, run.counts.worst);
}

TEST(image_run, stack_of_the_counted_call_is_its_own) {
    const ImageRun run = run_image(options_for(kCountProbe), {3, 10});
    EXPECT_EQ(run.printed.at("stack_bytes"), 0u);
    EXPECT_EQ(run.printed.at("dug_stack_bytes"), 64u);
}

TEST(image_run, words_may_come_from_a_file) {
    const std::string path =
        std::filesystem::temp_directory_path() / ("count," + std::to_string(getpid()) + ".bin");
    const std::uint32_t words[] = {3, 10};
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char *>(words), sizeof words);
    EXPECT_EQ(run_image(options_for(kCountProbe), {}, path).counts.total,
              run_image(options_for(kCountProbe), {3, 10}).counts.total);
    const std::string error = error_of([&] { run_image(options_for(kCountProbe), {3, 10}, path); });
    expect_contains(error, "give one of them");
    expect_contains(error_of([] { run_image(options_for(kCountProbe), {}, "/none.bin"); }),
                    "--data /none.bin: expected a file of 1 .. 16777216 bytes");
    std::filesystem::remove(path);
}

TEST(image_run, image_that_fails_is_named_with_its_last_line) {
    const std::string error = error_of([] { run_image(options_for(kCountProbe), {1, 13, 1}); });
    expect_contains(error, "count_probe.elf: qemu-system-arm ended with code 1: dug_stack_bytes");
}

TEST(image_run, image_that_does_not_end_is_named) {
    QemuOptions options = options_for(kShmImage);
    options.answer_time = std::chrono::milliseconds(300);
    expect_contains(error_of([&] { run_image(options, {}); }), "has not ended after 300 ms");
}

TEST(image_run, count_prints_what_it_found) {
    const Outcome outcome =
        bench("count --image " + quoted(kCountProbe) + " --word 1 --word 20 --profile all");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const auto json = nlohmann::json::parse(outcome.output);
    EXPECT_EQ(json["passes"], 2);
    EXPECT_EQ(json["worst"], 42);
    EXPECT_EQ(json["worst_pass"], 1);
    EXPECT_EQ(json["median"], 5);
    EXPECT_EQ(json["mean"], 23.5);
    EXPECT_EQ(json["printed"]["dug_stack_bytes"], 64);
    EXPECT_FALSE(json["profile"].empty());
}

} // namespace
} // namespace quiesce
