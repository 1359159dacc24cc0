#include <gtest/gtest.h>

#include "edge_rate.h"

namespace quiesced {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// A line of this rate for so many seconds. Returns how often there was news.
int run(EdgeRate &rate, std::uint32_t rate_Hz, int seconds, std::int64_t &now_ns) {
    int news = 0;
    for (std::uint32_t i = 0; i < rate_Hz * static_cast<std::uint32_t>(seconds); ++i) {
        now_ns += kSecond_ns / rate_Hz;
        news += rate.count(1, now_ns) ? 1 : 0;
    }
    return news;
}

TEST(EdgeRate, a_rate_within_two_percent_is_no_news) {
    EdgeRate rate;
    std::int64_t now_ns = 5;
    rate.start(1000);
    EXPECT_EQ(run(rate, 1000, 20, now_ns), 0);
    EXPECT_EQ(run(rate, 985, 20, now_ns), 0);
    EXPECT_EQ(run(rate, 1015, 20, now_ns), 0);
    EXPECT_FALSE(rate.is_off());
}

TEST(EdgeRate, a_rate_that_stays_off_is_told_once_and_so_is_its_end) {
    for (const std::uint32_t wrong_Hz : {500U, 714U, 970U, 1030U, 2000U, 4000U}) {
        EdgeRate rate;
        std::int64_t now_ns = 5;
        rate.start(1000);
        EXPECT_EQ(run(rate, wrong_Hz, 30, now_ns), 1) << wrong_Hz;
        EXPECT_TRUE(rate.is_off());
        EXPECT_NEAR(rate.rate_Hz(), wrong_Hz, 2);
        EXPECT_EQ(run(rate, 1000, 30, now_ns), 1) << wrong_Hz;
        EXPECT_FALSE(rate.is_off());
    }
}

TEST(EdgeRate, a_gap_is_not_a_rate) {
    EdgeRate rate;
    std::int64_t now_ns = 5;
    rate.start(1000);
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(run(rate, 1000, 3, now_ns), 0);
        now_ns += kSecond_ns / 2;
        EXPECT_EQ(run(rate, 1000, 3, now_ns), 0);
        now_ns += 20 * kSecond_ns;
    }
}

TEST(EdgeRate, edges_that_are_taken_together_count) {
    EdgeRate rate;
    rate.start(1000);
    for (std::int64_t now_ns = 1; now_ns < 30 * kSecond_ns; now_ns += 4'000'000) {
        EXPECT_FALSE(rate.count(4, now_ns));
    }
}

} // namespace
} // namespace quiesced
