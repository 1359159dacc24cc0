#include "images.h"
#include "qemu_shm_link.h"
#include "qemu_uart_link.h"

namespace quiesce {
namespace {

/// Without the report, which costs what the law makes of it.
lockstep_stimulus_t plain_stimulus(std::uint32_t tick) {
    lockstep_stimulus_t stimulus = varied_stimulus(tick);
    stimulus.flags &= ~LOCKSTEP_REPORT;
    return stimulus;
}

InstructionCounts counts_of(const QemuOptions &options, std::uint32_t ticks) {
    QemuShmLink target(options);
    lockstep_reply_t reply;
    target.start(nullptr, default_params(), {});
    for (std::uint32_t tick = 0; tick < ticks; ++tick) {
        target.exchange(plain_stimulus(tick), reply);
    }
    return target.finish().value();
}

TEST(instruction_counter, repeats_exactly) {
    const InstructionCounts first = counts_of(options_for(kShmImage), 2000);
    const InstructionCounts second = counts_of(options_for(kShmImage), 2000);
    EXPECT_EQ(first.median, second.median);
    EXPECT_EQ(first.worst, second.worst);
    EXPECT_EQ(first.total, second.total);
    EXPECT_EQ(first.ticks, 2000u);
    EXPECT_GT(first.median, 100u);
}

TEST(instruction_counter, whole_blocks_give_the_count_of_single_instructions) {
    QemuOptions each = options_for(kShmImage);
    each.count_each_instruction = true;
    for (const std::uint32_t ticks : {1u, 3u, 2000u}) {
        const InstructionCounts by_block = counts_of(options_for(kShmImage), ticks);
        const InstructionCounts by_instruction = counts_of(each, ticks);
        EXPECT_EQ(by_block.median, by_instruction.median);
        EXPECT_EQ(by_block.worst, by_instruction.worst);
    }
}

TEST(instruction_counter, both_links_count_the_same_tick) {
    QemuUartLink uart(options_for(kUartImage), {0, 0});
    lockstep_reply_t reply;
    uart.start(nullptr, default_params(), {});
    for (std::uint32_t tick = 0; tick < 300; ++tick) {
        uart.exchange(plain_stimulus(tick), reply);
    }
    const InstructionCounts over_uart = uart.finish().value();
    const InstructionCounts over_shm = counts_of(options_for(kShmImage), 300);
    // The same objects, linked at other addresses: only library alignment may differ.
    EXPECT_NEAR(static_cast<double>(over_uart.median), static_cast<double>(over_shm.median), 8);
}

TEST(instruction_counter, no_tick_means_no_count) {
    QemuShmLink target(options_for(kShmImage));
    target.start(nullptr, default_params(), {});
    EXPECT_FALSE(target.finish());
}

TEST(instruction_counter, none_switches_it_off) {
    QemuShmLink target(uncounted(kShmImage));
    lockstep_reply_t reply;
    target.start(nullptr, default_params(), {});
    target.exchange(varied_stimulus(0), reply);
    EXPECT_FALSE(target.finish());
}

TEST(instruction_counter, missing_plugin_and_unmarked_image_are_named) {
    QemuOptions options = options_for(kShmImage);
    options.plugin_path = "no/such.so";
    expect_contains(error_of([&] { QemuShmLink{options}; }), "plugin no/such.so: not found");
    expect_contains(error_of([] { QemuShmLink{options_for(kEchoImage)}; }),
                    "has no symbol quiesce_count_begin");
}

} // namespace
} // namespace quiesce
