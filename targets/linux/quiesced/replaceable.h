/// A device that may vanish while the control loop runs. The loop gives it up; the other thread
/// closes it and tries once a second to open it anew; the loop then picks it up. Neither waits for
/// the other.
#ifndef QUIESCED_REPLACEABLE_H
#define QUIESCED_REPLACEABLE_H

#include <cstdint>
#include <string>
#include <utility>

#include "input_error.h"
#include "mailbox.h"

namespace quiesced {

/// Pointer: a unique_ptr, with whatever closes the device.
template <typename Pointer>
class Replaceable {
  public:
    /// Before the loop starts.
    void start_with(Pointer device) { in_use_ = std::move(device); }

    /// Loop: the device; null while there is none.
    auto *get() const { return in_use_.get(); }

    /// Loop: it does not work any more.
    void give_up() { (void)given_up_.put(std::move(in_use_)); }

    /// Loop: takes the new one if there is one. Returns true iff it did.
    bool pick_up() { return fresh_.is_full() && fresh_.take(in_use_); }

    /// Other thread, about once a second: open() throws InputError where it cannot. Returns a line
    /// for the log when that is news, else "".
    template <typename Open>
    std::string maintain(const char *name, Open &&open) {
        Pointer old;
        if (given_up_.take(old)) {
            is_gone_ = true;
            is_reported_ = false;
        }
        old.reset();
        if (!is_gone_) {
            return "";
        }
        try {
            (void)fresh_.put(open());
            is_gone_ = false;
            return std::string(name) + " is back";
        } catch (const quiesce::InputError &error) {
            const bool is_news = !std::exchange(is_reported_, true);
            return is_news
                       ? std::string(name) + " is gone, looked for every second: " + error.what()
                       : "";
        }
    }

  private:
    Pointer in_use_{};
    Mailbox<Pointer> given_up_;
    Mailbox<Pointer> fresh_;
    bool is_gone_ = false;
    bool is_reported_ = false;
};

} // namespace quiesced

#endif
