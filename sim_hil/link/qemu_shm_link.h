/// The shm image: the fast link to an emulated target.
#ifndef QUIESCE_QEMU_SHM_LINK_H
#define QUIESCE_QEMU_SHM_LINK_H

#include "shm_image.h"

namespace quiesce {

class QemuShmLink final : public ControllerLink {
  public:
    explicit QemuShmLink(const QemuOptions &options) : image_(options, sizeof(mailbox_t)) {}

    std::string target() const override { return "mps2"; }
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override;
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    std::optional<InstructionCounts> finish() override { return image_.finish(); }

    /// Deepest stack use of the image in bytes. Only after finish.
    std::uint32_t stack_used_bytes() { return image_.plain().stack_used_bytes; }

    pid_t process_id() const { return image_.process_id(); }

  private:
    ShmImage image_;
};

} // namespace quiesce

#endif
