/// An output line: written when its level changes and again and again, because something else may
/// change it; before that it is read back.
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
        const bool is_held = is_new || holds(line.get());
        level_ = is_active;
        if (!gpio_set(line.get(), is_active) || !is_held) {
            log.log(LogLevel::error, is_held ? "%s is gone" : "%s does not hold its level", name_);
            line.give_up();
        }
    }

  private:
    /// A level that cannot be read counts as held: writing tells whether the line is gone.
    bool holds(gpio_line_t *line) const {
        bool found = level_;
        return !gpio_get(line, &found) || found == level_;
    }

    const char *name_;
    bool level_ = false;
};

} // namespace quiesced

#endif
