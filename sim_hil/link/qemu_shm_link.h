/// The shm image under QEMU, driven through RAM that the bench shares with it (mailbox.h): the fast
/// link to an emulated target.
#ifndef QUIESCE_QEMU_SHM_LINK_H
#define QUIESCE_QEMU_SHM_LINK_H

#include "controller_link.h"
#include "firmware_comm.h"
#include "instruction_counter.h"
#include "qemu_process.h"

namespace quiesce {

/// Memory file of MAILBOX_BYTES, mapped. QEMU opens it by its number; it never has a name.
class SharedMailbox {
  public:
    SharedMailbox();
    SharedMailbox(const SharedMailbox &) = delete;
    SharedMailbox &operator=(const SharedMailbox &) = delete;
    ~SharedMailbox();

    mailbox_t *operator->() const { return mailbox_; }
    int descriptor() const { return file_.number(); }

  private:
    FileDescriptor file_;
    mailbox_t *mailbox_;
};

class QemuShmLink final : public ControllerLink {
  public:
    explicit QemuShmLink(const QemuOptions &options);

    std::string target() const override { return "mps2"; }
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override;
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    std::optional<InstructionCounts> finish() override;

    /// Deepest stack use of the image in bytes. Only after finish.
    std::uint32_t stack_used_bytes() const { return mailbox_->stack_used_bytes; }

    pid_t process_id() const { return process_.id(); }

  private:
    void request(std::uint32_t operation);
    void wait_for_reply(std::uint32_t sequence);
    bool has_replied(std::uint32_t sequence) const;
    void check_layout() const;

    QemuOptions options_;
    SharedMailbox mailbox_;
    InstructionCounter counter_;
    QemuProcess process_;
};

} // namespace quiesce

#endif
