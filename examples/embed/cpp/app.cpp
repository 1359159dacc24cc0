// A controller on CAN: prints the frames of its first second as candump does, for
// `quiesce can decode`.
#include <cstdint>
#include <cstdio>
#include <memory>

#include <node.h>

namespace {

class Controller {
  public:
    Controller() {
        quiesce_params_t params;
        quiesce_params_default(&params);
        is_running_ = node_init(node_.get(), nullptr, &params, {NODE_ENABLE_BOARD, 0});
    }

    bool is_running() const { return is_running_; }

    /// One tick with this sample; the number of frames, which `frames` has then.
    std::uint32_t tick(std::int32_t counts, can_frame_t (&frames)[NODE_MAX_FRAMES]) {
        node_inputs_t inputs{};
        inputs.enable = true;
        inputs.ticks_elapsed = 1;
        inputs.sensor[0].is_fresh = true;
        inputs.sensor[0].counts = counts;
        return node_tick(node_.get(), &inputs, frames);
    }

  private:
    std::unique_ptr<node_t> node_ = std::make_unique<node_t>();
    bool is_running_ = false;
};

} // namespace

int main() {
    Controller controller;
    can_frame_t frames[NODE_MAX_FRAMES] = {};
    for (int tick = 0; tick < 1000; ++tick) {
        const std::uint32_t count = controller.tick(tick % 50 - 25, frames);
        for (std::uint32_t i = 0; i < count; ++i) {
            std::printf("(%d.%03d000) can0 %03X#", tick / 1000, tick % 1000,
                        unsigned{frames[i].id});
            for (std::uint32_t byte = 0; byte < frames[i].length; ++byte) {
                std::printf("%02X", unsigned{frames[i].data[byte]});
            }
            std::printf("\n");
        }
    }
    return controller.is_running() ? 0 : 1;
}
