// A controller on CAN: exits 0 where it sends its frames, and its parameters are named.
#include <cstdint>
#include <cstring>
#include <iostream>
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

    bool is_running() const {
        return is_running_;
    }

    std::uint32_t tick() {
        node_inputs_t inputs{};
        inputs.enable = true;
        inputs.ticks_elapsed = 1;
        inputs.sensor[0].is_fresh = true;
        return node_tick(node_.get(), &inputs, frames_);
    }

private:
    std::unique_ptr<node_t> node_ = std::make_unique<node_t>();
    can_frame_t frames_[NODE_MAX_FRAMES] = {};
    bool is_running_ = false;
};

} // namespace

int main() {
    Controller controller;
    std::uint32_t frames = 0;
    for (int tick = 0; tick < 1000; ++tick) {
        frames += controller.tick();
    }
    std::cout << frames << " frames in 1000 ticks; parameter 0 is " << quiesce_param_info(0)->name
              << '\n';
    return controller.is_running() && frames >= 1000 ? 0 : 1;
}
