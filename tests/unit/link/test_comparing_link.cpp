#include "comparing_link.h"
#include "images.h"
#include "in_process_link.h"

#include <gtest/gtest.h>

#include <cstring>

namespace quiesce {
namespace {

/// The host's controller with one bit of one word wrong in one tick of one run.
class FaultyLink final : public ControllerLink {
  public:
    FaultyLink(int run, int tick, std::size_t word) : bad_run_(run), bad_tick_(tick), word_(word) {}

    std::string target() const override { return "faulty"; }
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override {
        ++run_;
        tick_ = 0;
        const StartAnswer answer = host_.start(board, params, tables);
        return accepts ? answer : StartAnswer{false, {refused_table, 0}};
    }
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override {
        host_.exchange(stimulus, reply);
        if (run_ == bad_run_ && tick_++ == bad_tick_) {
            reinterpret_cast<unsigned char *>(&reply)[4 * word_] ^= 1u;
        }
    }
    std::optional<InstructionCounts> finish() override { return std::nullopt; }

    bool accepts = true;
    std::uint32_t refused_table = QUIESCE_TABLE_OK;

  private:
    InProcessLink host_;
    int bad_run_;
    int bad_tick_;
    std::size_t word_;
    int run_ = -1;
    int tick_ = 0;
};

void run_twice(ComparingLink &link) {
    for (int run = 0; run < 2; ++run) {
        link.start(nullptr, default_params(), {});
        for (std::uint32_t tick = 0; tick < 100; ++tick) {
            lockstep_reply_t reply;
            link.exchange(varied_stimulus(tick), reply);
        }
    }
}

TEST(comparing_link, equal_targets_have_no_mismatch) {
    InProcessLink first, second;
    ComparingLink link(first, second);
    run_twice(link);
    EXPECT_EQ(link.mismatches(), 0u);
    EXPECT_FALSE(link.first_mismatch());
}

TEST(comparing_link, one_wrong_bit_in_any_word_is_found_and_named) {
    for (std::size_t word = 0; word < sizeof(lockstep_reply_t) / 4; ++word) {
        InProcessLink host;
        FaultyLink faulty(1, 42, word);
        ComparingLink link(host, faulty);
        run_twice(link);
        EXPECT_EQ(link.mismatches(), 1u);
        ASSERT_TRUE(link.first_mismatch());
        EXPECT_EQ(link.first_mismatch()->run, 1u);
        EXPECT_EQ(link.first_mismatch()->tick, 42);
        EXPECT_NE(link.first_mismatch()->field, "");
    }
}

TEST(comparing_link, the_plant_sees_the_reference) {
    InProcessLink host, alone;
    FaultyLink faulty(0, 0, 0);
    ComparingLink link(host, faulty);
    lockstep_reply_t expected, actual;
    link.start(nullptr, default_params(), {});
    alone.start(nullptr, default_params(), {});
    link.exchange(varied_stimulus(0), actual);
    alone.exchange(varied_stimulus(0), expected);
    EXPECT_EQ(std::memcmp(&expected, &actual, sizeof expected), 0);
}

TEST(comparing_link, disagreement_on_parameters_is_an_error) {
    InProcessLink host;
    FaultyLink faulty(0, 0, 0);
    faulty.accepts = false;
    ComparingLink link(host, faulty);
    expect_contains(error_of([&] { link.start(nullptr, default_params(), {}); }), "disagree");
}

TEST(comparing_link, disagreement_on_why_a_table_is_refused_is_an_error) {
    const Tables tables = {{std::vector<std::uint32_t>(20, 7), {}}};
    InProcessLink host;
    FaultyLink faulty(0, 0, 0);
    ComparingLink link(host, faulty);
    EXPECT_EQ(link.start(nullptr, default_params(), tables).table.verdict,
              std::uint32_t{QUIESCE_TABLE_MAGIC});
    faulty.accepts = false;
    faulty.refused_table = QUIESCE_TABLE_CRC;
    expect_contains(error_of([&] { link.start(nullptr, default_params(), tables); }), "disagree");
}

} // namespace
} // namespace quiesce
