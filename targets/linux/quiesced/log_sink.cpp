#include "log_sink.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "clock.h"
#include "input_error.h"

namespace quiesced {

namespace {

// systemd's sd-daemon(3): "<N>" with syslog's number at the start of a line is its priority.
constexpr std::array<const char *, 4> kJournalPrefix = {"<3>", "<4>", "<6>", "<7>"};
constexpr std::array<const char *, 4> kLevelName = {"error: ", "warning: ", "", "debug: "};

const char *of_level(const std::array<const char *, 4> &texts, LogLevel level) {
    return texts[static_cast<std::size_t>(level)];
}

/// A pipe that takes nothing, or nobody reads, would block the thread: such lines are dropped.
bool can_take(int fd) {
    pollfd ready = {fd, POLLOUT, 0};
    return poll(&ready, 1, 0) == 1 && (ready.revents & POLLOUT) != 0;
}

} // namespace

LogSink::LogSink(const LogConfig &config) : config_(config) {
    if (config.to == "journal" || config.to == "stderr") {
        return;
    }
    file_ = open(config.to.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOCTTY, 0640);
    if (file_ < 0) {
        throw quiesce::InputError("log.to: " + config.to + ": " + std::strerror(errno));
    }
}

LogSink::~LogSink() {
    if (file_ >= 0) {
        close(file_);
    }
}

void LogSink::write(const LogLine &line) {
    if (line.level > config_.level) {
        return;
    }
    if (file_ >= 0) {
        write_to_file(line);
    } else {
        write_to_stderr(line.level, line.text.data());
    }
}

void LogSink::write(LogLevel level, const std::string &text) {
    LogLine line{level, realtime_ns(), {}};
    (void)std::snprintf(line.text.data(), line.text.size(), "%s", text.c_str());
    write(line);
}

void LogSink::write_to_file(const LogLine &line) {
    // What a full disk cut off ends where the next line begins.
    const std::string text = (has_partial_line_ ? "\n" : "") + iso_time(line.time_ns) + " " +
                             of_level(kLevelName, line.level) + line.text.data() + "\n";
    const ssize_t written = ::write(file_, text.data(), text.size());
    if (written == static_cast<ssize_t>(text.size())) {
        has_partial_line_ = false;
        if (is_failing_) {
            is_failing_ = false;
            write_to_stderr(LogLevel::warning, "log file " + config_.to + " takes lines again; " +
                                                   std::to_string(lost_in_row_) + " are missing");
        }
        return;
    }
    const int why = written < 0 ? errno : ENOSPC;
    has_partial_line_ = has_partial_line_ || written > 0;
    if (!is_failing_) {
        is_failing_ = true;
        lost_in_row_ = 0;
        write_to_stderr(LogLevel::error, "log file " + config_.to + ": " + std::strerror(why) +
                                             "; lines are dropped until it takes them");
    }
    ++lost_;
    ++lost_in_row_;
}

void LogSink::write_to_stderr(LogLevel level, const std::string &text) {
    const bool is_journal = config_.to == "journal";
    const std::string line = (is_journal ? of_level(kJournalPrefix, level) : "quiesced: ") +
                             std::string(is_journal ? "" : of_level(kLevelName, level)) + text +
                             "\n";
    if (!can_take(STDERR_FILENO) ||
        ::write(STDERR_FILENO, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
        ++lost_;
    }
}

} // namespace quiesced
