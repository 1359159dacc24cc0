/// Files with one mistake in them, and the message that must answer it.
#ifndef QUIESCE_TEST_FILE_MISTAKES_H
#define QUIESCE_TEST_FILE_MISTAKES_H

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "input_error.h"

namespace quiesce {

inline std::string read(const std::string &file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// A file that is there as long as the object.
class TemporaryFile {
  public:
    explicit TemporaryFile(const std::string &text, const std::string &ending = ".toml")
        : path_((std::filesystem::temp_directory_path() /
                 ("quiesce_test_" + std::to_string(::getpid()) + ending))
                    .string()) {
        std::ofstream(path_) << text;
    }
    ~TemporaryFile() { std::filesystem::remove(path_); }
    TemporaryFile(const TemporaryFile &) = delete;
    TemporaryFile &operator=(const TemporaryFile &) = delete;

    const std::string &path() const { return path_; }

  private:
    std::string path_;
};

/// One mistake: in a good file, the first from becomes to; the message must contain words.
struct Mistake {
    const char *name;
    const char *from;
    const char *to;
    const char *words;
};

inline void PrintTo(const Mistake &mistake, std::ostream *out) {
    *out << mistake.name;
}

inline std::string spoilt(const std::string &good, const Mistake &mistake) {
    const std::string from = mistake.from;
    const std::size_t at = good.find(from);
    EXPECT_NE(at, std::string::npos) << "the good file lost: " << from;
    return good.substr(0, at) + mistake.to + good.substr(at + from.size());
}

template <typename Load>
void expect_message(const std::string &text, const std::string &words, Load load) {
    const TemporaryFile file(text);
    try {
        load(file.path());
        FAIL() << "accepted; expected a message with: " << words;
    } catch (const InputError &error) {
        const std::string message = error.what();
        EXPECT_EQ(message.rfind(file.path(), 0), 0u) << "names the file: " << message;
        EXPECT_NE(message.find(words), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << "one line: " << message;
    }
}

} // namespace quiesce

#endif
