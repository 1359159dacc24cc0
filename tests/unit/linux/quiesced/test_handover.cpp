#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "mailbox.h"
#include "replaceable.h"

namespace quiesced {
namespace {

TEST(Mailbox, holds_one_value_until_it_is_taken) {
    Mailbox<int> box;
    int value = 0;
    EXPECT_FALSE(box.take(value));
    EXPECT_TRUE(box.put(1));
    EXPECT_FALSE(box.put(2));
    ASSERT_TRUE(box.take(value));
    EXPECT_EQ(value, 1);
    EXPECT_TRUE(box.put(3));
}

TEST(Mailbox, what_is_looked_at_stays_until_it_is_dropped) {
    Mailbox<int> box;
    EXPECT_EQ(box.look(), nullptr);
    EXPECT_TRUE(box.put(1));
    ASSERT_NE(box.look(), nullptr);
    EXPECT_EQ(*box.look(), 1);
    EXPECT_FALSE(box.put(2));
    box.drop();
    EXPECT_TRUE(box.put(3));
}

TEST(Mailbox, every_value_arrives_once_between_two_threads) {
    constexpr int count = 100'000;
    Mailbox<int> box;
    std::thread sender([&] {
        for (int i = 0; i < count;) {
            if (box.put(i)) {
                ++i;
            } else {
                std::this_thread::yield();
            }
        }
    });
    for (int expected = 0, value = -1; expected < count;) {
        if (box.take(value)) {
            EXPECT_EQ(value, expected++);
        } else {
            std::this_thread::yield();
        }
    }
    sender.join();
}

using Device = std::unique_ptr<int>;

Device refuse() {
    throw quiesce::InputError("not there");
}

TEST(Replaceable, a_device_that_works_is_left_alone) {
    Replaceable<Device> slot;
    slot.start_with(std::make_unique<int>(1));
    EXPECT_EQ(slot.maintain("it", refuse), "");
    EXPECT_EQ(*slot.get(), 1);
}

TEST(Replaceable, nothing_is_opened_where_nothing_was) {
    Replaceable<Device> slot;
    EXPECT_EQ(slot.maintain("it", refuse), "");
    EXPECT_FALSE(slot.pick_up());
}

TEST(Replaceable, a_device_comes_back_and_each_change_is_told_once) {
    Replaceable<Device> slot;
    slot.start_with(std::make_unique<int>(1));
    slot.give_up();
    EXPECT_EQ(slot.get(), nullptr);
    EXPECT_EQ(slot.maintain("it", refuse), "it is gone, looked for every second: not there");
    EXPECT_EQ(slot.maintain("it", refuse), "");
    EXPECT_FALSE(slot.pick_up());
    EXPECT_EQ(slot.maintain("it", [] { return std::make_unique<int>(2); }), "it is back");
    ASSERT_TRUE(slot.pick_up());
    EXPECT_EQ(*slot.get(), 2);
    EXPECT_EQ(slot.maintain("it", refuse), "");
    // And once more.
    slot.give_up();
    EXPECT_EQ(slot.maintain("it", [] { return std::make_unique<int>(3); }), "it is back");
    ASSERT_TRUE(slot.pick_up());
    EXPECT_EQ(*slot.get(), 3);
}

TEST(Replaceable, the_old_device_is_closed_before_the_new_one_is_opened) {
    Replaceable<std::shared_ptr<int>> slot;
    const auto device = std::make_shared<int>(1);
    slot.start_with(device);
    slot.give_up();
    (void)slot.maintain("it", [&] {
        EXPECT_EQ(device.use_count(), 1);
        return device;
    });
}

} // namespace
} // namespace quiesced
