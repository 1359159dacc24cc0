/// The bus of the rig in the computer, as python-can has it.
#include "multicast_bus.h"

#include <chrono>
#include <gtest/gtest.h>
#include <thread>
#include <unistd.h>

#include "input_error.h"

namespace quiesce {
namespace {

can_frame_t frame_of(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
    can_frame_t frame{};
    frame.id = id;
    for (const std::uint8_t byte : data) {
        frame.data[frame.length++] = byte;
    }
    return frame;
}

bool unpacks(const std::vector<std::uint8_t> &bytes) {
    can_frame_t frame{};
    return unpack_frame(bytes.data(), bytes.size(), frame);
}

TEST(MulticastBus, frames_survive_packing) {
    can_frame_t extended = frame_of(0x1FFFFFFF, {1, 2, 3, 4, 5, 6, 7, 8});
    extended.is_extended = true;
    can_frame_t remote = frame_of(0x7FF, {});
    remote.is_remote = true;
    remote.length = 4;
    for (const can_frame_t &frame : {frame_of(0x123, {}), frame_of(0, {0xFF}), extended, remote}) {
        can_frame_t back{};
        const std::vector<std::uint8_t> bytes = pack_frame(frame, 1.7e9);
        ASSERT_TRUE(unpack_frame(bytes.data(), bytes.size(), back));
        EXPECT_EQ(back.id, frame.id);
        EXPECT_EQ(back.length, frame.length);
        EXPECT_EQ(back.is_extended, frame.is_extended);
        EXPECT_EQ(back.is_remote, frame.is_remote);
        EXPECT_TRUE(std::equal(std::begin(back.data), std::end(back.data), frame.data));
    }
}

TEST(MulticastBus, what_is_no_classic_frame_is_dropped) {
    std::vector<std::uint8_t> good = pack_frame(frame_of(0x123, {1, 2}), 0.0);
    for (std::size_t length = 0; length < good.size(); ++length) { // cut off
        EXPECT_FALSE(unpacks({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)}));
    }
    can_frame_t id = frame_of(0x800, {});
    EXPECT_FALSE(unpacks(pack_frame(id, 0.0)));
    can_frame_t length = frame_of(1, {});
    length.length = 9;
    EXPECT_FALSE(unpacks(pack_frame(length, 0.0)));
    EXPECT_FALSE(unpacks({0xC0}));       // nil
    EXPECT_FALSE(unpacks({0x80}));       // an empty map
    EXPECT_FALSE(unpacks({0xC1, 0xC1})); // no MessagePack
}

TEST(MulticastBus, is_named_by_group_and_port) {
    for (const char *name : {"", "239.74.163.2", "239.74.163.2:", "239.74.163.2:0",
                             "239.74.163.2:70000", "10.0.0.1:43113", "host:1", "239.74.163.2:1x"}) {
        EXPECT_THROW(MulticastBus{name}, InputError) << name;
    }
}

TEST(MulticastBus, each_hears_the_other_and_not_itself) {
    const std::string name = "239.74.163.2:" + std::to_string(20000 + getpid() % 20000);
    MulticastBus one(name);
    MulticastBus other(name);
    ASSERT_TRUE(one.send(frame_of(0x321, {7})));
    can_frame_t frame{};
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!other.receive(frame) && std::chrono::steady_clock::now() < end) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(frame.id, 0x321u);
    EXPECT_EQ(frame.data[0], 7);
    EXPECT_FALSE(one.receive(frame));
}

} // namespace
} // namespace quiesce
