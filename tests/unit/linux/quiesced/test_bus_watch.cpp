#include <gtest/gtest.h>

#include "bus_watch.h"

namespace quiesced {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;

TEST(BusWatch, a_bus_that_is_off_has_failed_at_once_and_until_it_is_up) {
    BusWatch watch;
    watch.look(CAN_BUS_UP, 0);
    EXPECT_FALSE(watch.has_failed());
    watch.look(CAN_BUS_OFF, kTick_ns);
    EXPECT_TRUE(watch.has_failed());
    EXPECT_FALSE(watch.takes_frames());
    watch.look(CAN_BUS_PASSIVE, 2 * kTick_ns);
    EXPECT_FALSE(watch.has_failed());
    EXPECT_TRUE(watch.takes_frames());
}

TEST(BusWatch, a_bus_that_is_down_has_failed_after_its_patience) {
    BusWatch watch;
    watch.look(CAN_BUS_UP, 0);
    for (std::int64_t now_ns = kTick_ns; now_ns < BusWatch::kPatience_ns; now_ns += kTick_ns) {
        watch.look(CAN_BUS_DOWN, now_ns);
        ASSERT_FALSE(watch.has_failed()) << now_ns;
        ASSERT_FALSE(watch.takes_frames());
    }
    watch.look(CAN_BUS_DOWN, BusWatch::kPatience_ns);
    EXPECT_TRUE(watch.has_failed());
    watch.look(CAN_BUS_UP, BusWatch::kPatience_ns + kTick_ns);
    EXPECT_FALSE(watch.has_failed());
}

TEST(BusWatch, a_bus_that_was_never_up_has_not_failed) {
    BusWatch watch;
    watch.look(CAN_BUS_DOWN, 100 * BusWatch::kPatience_ns);
    EXPECT_FALSE(watch.has_failed());
    EXPECT_FALSE(watch.takes_frames());
}

} // namespace
} // namespace quiesced
