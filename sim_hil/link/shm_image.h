/// An image under QEMU that is driven through RAM which the bench shares with it (mailbox.h).
#ifndef QUIESCE_SHM_IMAGE_H
#define QUIESCE_SHM_IMAGE_H

#include <optional>

#include "controller_link.h"
#include "firmware_comm.h"
#include "instruction_counter.h"
#include "mailbox_live.h"
#include "qemu_process.h"

namespace quiesce {

/// Memory file of MAILBOX_BYTES, mapped. QEMU opens it by its number; it never has a name.
class SharedMailbox {
  public:
    SharedMailbox();
    SharedMailbox(const SharedMailbox &) = delete;
    SharedMailbox &operator=(const SharedMailbox &) = delete;
    ~SharedMailbox();

    mailbox_live_t *operator->() const { return mailbox_; }
    int descriptor() const { return file_.number(); }

  private:
    FileDescriptor file_;
    mailbox_live_t *mailbox_;
};

class ShmImage {
  public:
    /// layout_bytes: of what this side shares with the image: mailbox_t, mailbox_live_t.
    ShmImage(const QemuOptions &options, std::size_t layout_bytes);

    mailbox_t &plain() { return mailbox_->plain; }
    mailbox_live_t &live() { return *mailbox_.operator->(); }
    const mailbox_live_t &live() const { return *mailbox_.operator->(); }

    /// MAILBOX_START. Throws InputError, too, where it was built from other sources.
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables);

    /// An operation, done when it returns. Throws InputError, one line, when it does not answer.
    void request(std::uint32_t operation);

    /// MAILBOX_STOP: the image ends by itself. Throws InputError when it does not.
    std::optional<InstructionCounts> finish();

    pid_t process_id() const { return process_.id(); }

  private:
    void wait_for_reply(std::uint32_t sequence);
    bool has_replied(std::uint32_t sequence) const;
    void check_layout() const;

    QemuOptions options_;
    std::size_t layout_bytes_;
    SharedMailbox mailbox_;
    InstructionCounter counter_;
    QemuProcess process_;
};

} // namespace quiesce

#endif
