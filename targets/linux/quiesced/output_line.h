/// An output line: written when its level changes, and once a second to notice that it is gone.
#ifndef QUIESCED_OUTPUT_LINE_H
#define QUIESCED_OUTPUT_LINE_H

#include "exchange.h"

namespace quiesced {

class OutputLine {
  public:
    explicit OutputLine(const char *name) : name_(name) {}

    /// rewrite: write it even where it has this level already.
    void set(Replaceable<Line> &line, bool is_active, bool rewrite, LogRing &log) {
        const bool is_new = line.pick_up();
        if (line.get() == nullptr || (!is_new && !rewrite && is_active == level_)) {
            return;
        }
        level_ = is_active;
        if (!gpio_set(line.get(), is_active)) {
            log.log(LogLevel::error, "%s is gone", name_);
            line.give_up();
        }
    }

  private:
    const char *name_;
    bool level_ = false;
};

} // namespace quiesced

#endif
