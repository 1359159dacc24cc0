/// Where log lines end: stderr, for journald or for people, or a file.
///
/// Writing never blocks for long and never fails the program: a file on a full disk is told once on
/// stderr when that starts and once when it ends; what could not be written is counted.
#ifndef QUIESCED_LOG_SINK_H
#define QUIESCED_LOG_SINK_H

#include <cstdint>
#include <string>

#include "log_ring.h"

namespace quiesced {

class LogSink {
  public:
    /// Throws InputError where the file cannot be opened.
    explicit LogSink(const LogConfig &config);
    LogSink(const LogSink &) = delete;
    LogSink &operator=(const LogSink &) = delete;
    ~LogSink();

    void write(const LogLine &line);
    void write(LogLevel level, const std::string &text);

    /// Lines that could not be written since the start.
    std::uint32_t lost() const { return lost_; }

  private:
    void write_to_file(const LogLine &line);
    void write_to_stderr(LogLevel level, const std::string &text);

    LogConfig config_;
    int file_ = -1;
    bool is_failing_ = false;
    bool has_partial_line_ = false;
    std::uint32_t lost_ = 0;
    std::uint32_t lost_in_row_ = 0;
};

} // namespace quiesced

#endif
