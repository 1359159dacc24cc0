/// The controller with its CAN interface as an image under QEMU.
#include <algorithm>

#include "controller_node.h"
#include "shm_image.h"

namespace quiesce {

namespace {

static_assert(kMostFrames <= MAILBOX_MAX_FRAMES, "what has come has room in the mailbox");

QemuOptions uncounted(const std::string &image_path) {
    QemuOptions out;
    out.image_path = image_path;
    out.plugin_path = "none";
    return out;
}

class NodeImage final : public ControllerNode {
  public:
    explicit NodeImage(const std::string &image_path)
        : image_(uncounted(image_path), sizeof(mailbox_live_t)) {}

    std::string target() const override { return "mps2"; }

    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override {
        return image_.start(board, params, tables);
    }

    std::vector<can_frame_t> tick(const std::vector<can_frame_t> &heard,
                                  const lockstep_stimulus_t &stimulus, const lockstep_pace_t &pace,
                                  lockstep_reply_t &reply) override {
        mailbox_live_t &box = image_.live();
        std::copy(heard.begin(), heard.end(), box.heard_frame);
        box.heard = static_cast<std::uint32_t>(heard.size());
        box.pace = pace;
        box.plain.stimulus = stimulus;
        image_.request(MAILBOX_STEP);
        reply = box.plain.reply;
        return said();
    }

    std::int32_t tick_rate_Hz() const override {
        return static_cast<std::int32_t>(image_.live().tick_rate_Hz);
    }

    std::vector<can_frame_t> farewell() override {
        image_.finish();
        return said();
    }

  private:
    std::vector<can_frame_t> said() const {
        const mailbox_live_t &box = image_.live();
        const std::size_t count = std::min<std::size_t>(box.said, MAILBOX_MAX_FRAMES);
        return {box.said_frame, box.said_frame + count};
    }

    ShmImage image_;
};

} // namespace

std::unique_ptr<ControllerNode> make_node_image(const std::string &image_path) {
    return std::make_unique<NodeImage>(image_path);
}

} // namespace quiesce
