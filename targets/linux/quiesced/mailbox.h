/// One value handed from one thread to another without a lock: the sender puts it where the last
/// one has been taken, the receiver takes it. One sender, one receiver; nothing blocks.
#ifndef QUIESCED_MAILBOX_H
#define QUIESCED_MAILBOX_H

#include <atomic>
#include <utility>

namespace quiesced {

template <typename Value>
class Mailbox {
  public:
    /// Receiver: is there something to take?
    bool is_full() const { return is_full_.load(std::memory_order_acquire); }

    /// Sender. Returns false, and keeps the value, iff the last one has not been taken.
    template <typename Given>
    bool put(Given &&value) {
        if (is_full()) {
            return false;
        }
        value_ = std::forward<Given>(value);
        is_full_.store(true, std::memory_order_release);
        return true;
    }

    /// Receiver. Returns false iff there is none.
    bool take(Value &value) {
        if (!is_full()) {
            return false;
        }
        value = std::move(value_);
        is_full_.store(false, std::memory_order_release);
        return true;
    }

    /// Receiver, who drops it later: until then it stays as it is. Null: there is none.
    const Value *look() const { return is_full() ? &value_ : nullptr; }
    void drop() { is_full_.store(false, std::memory_order_release); }

  private:
    Value value_{};
    std::atomic<bool> is_full_{false};
};

} // namespace quiesced

#endif
