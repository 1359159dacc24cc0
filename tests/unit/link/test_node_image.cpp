/// The controller with its CAN interface as an image: the frames and bits of the one in this
/// process.
#include "controller_node.h"

#include <cstring>

#include "images.h"
#include "multicast_bus.h"
#include "plant_frames.h"

namespace quiesce {
namespace {

const std::string kLiveImage = QUIESCE_IMAGES "/quiesce_mps2_live.elf";

/// A request to read every parameter in turn, with a counter and a CRC.
can_frame_t request(std::uint32_t tick) {
    static std::uint8_t alive = 0;
    quiesce_can_service_request_t ask{};
    ask.operation = QUIESCE_CAN_SERVICE_REQUEST_OPERATION_READ_CHOICE;
    ask.param_index = static_cast<std::uint8_t>(tick / 20 % QUIESCE_PARAM_COUNT);
    const e2e_layout_t &layout = quiesce_can_messages[QUIESCE_CAN_AT_SERVICE_REQUEST].e2e;
    can_frame_t frame = empty_frame(QUIESCE_CAN_AT_SERVICE_REQUEST);
    quiesce_can_service_request_pack(frame.data, &ask, sizeof frame.data);
    e2e_protect(&layout, &alive, &frame);
    return frame;
}

void expect_same(const std::vector<can_frame_t> &a, const std::vector<can_frame_t> &b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(pack_frame(a[i], 0.0), pack_frame(b[i], 0.0));
    }
}

void expect_same_runs(const quiesce_board_t *board, const quiesce_params_t &params) {
    const auto here = make_node_here();
    const auto image = make_node_image(kLiveImage);
    ASSERT_TRUE(here->start(board, params, {}));
    ASSERT_TRUE(image->start(board, params, {}));
    EXPECT_EQ(image->tick_rate_Hz(), params.tick_rate_Hz);
    std::size_t answers = 0;
    for (std::uint32_t tick = 0; tick < 2500; ++tick) {
        const auto heard = tick % 20 == 7 ? std::vector{request(tick)} : std::vector<can_frame_t>();
        lockstep_stimulus_t stimulus = varied_stimulus(tick);
        stimulus.flags |= tick % 211 == 210 ? LOCKSTEP_LOST : 0u;
        const lockstep_pace_t pace = {tick % 50, tick % 70, tick / 100, {}, 0};
        lockstep_reply_t expected{}, actual{};
        const auto said_here = here->tick(heard, stimulus, pace, expected);
        expect_same(said_here, image->tick(heard, stimulus, pace, actual));
        ASSERT_EQ(std::memcmp(&expected, &actual, sizeof expected), 0) << "tick " << tick;
        for (const can_frame_t &frame : said_here) {
            answers += frame.id == quiesce_can_messages[QUIESCE_CAN_AT_SERVICE_REPLY].e2e.id;
        }
    }
    EXPECT_GT(answers, 100u);
    expect_same(here->farewell(), image->farewell());
}

TEST(node_image, sends_and_answers_like_the_host) {
    expect_same_runs(nullptr, default_params());
}

TEST(node_image, has_all_sensors_and_dampers_of_a_board) {
    const quiesce_board_t board = largest_board();
    expect_same_runs(&board, default_params());
}

TEST(node_image, another_image_is_refused_in_one_line) {
    const auto node = make_node_image(kShmImage);
    const std::string error = error_of([&] { node->start(nullptr, default_params(), {}); });
    expect_contains(error, "was built from other sources than this bench");
    EXPECT_EQ(error.find('\n'), std::string::npos);
}

} // namespace
} // namespace quiesce
