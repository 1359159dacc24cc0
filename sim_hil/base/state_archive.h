/// The state of a simulation as bytes: one list of members serves saving and loading. The bytes are
/// for the same program on the same kind of machine.
#ifndef QUIESCE_STATE_ARCHIVE_H
#define QUIESCE_STATE_ARCHIVE_H

#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "input_error.h"

namespace quiesce {

class StateArchive {
  public:
    /// Saves.
    StateArchive() = default;
    /// Loads what has been saved.
    explicit StateArchive(std::vector<std::uint8_t> bytes)
        : bytes_(std::move(bytes)), is_loading_(true) {}

    bool is_loading() const { return is_loading_; }

    /// Saves a value, or overwrites it with what was saved in its place. Throws InputError where
    /// the bytes end before.
    template <typename T>
    void operator()(T &value) {
        static_assert(std::is_trivially_copyable_v<T>);
        raw(&value, sizeof value);
    }

    /// The length belongs to what it is the state of. Throws InputError where another was saved.
    template <typename T>
    void operator()(std::vector<T> &values) {
        sized(values);
    }
    template <typename T>
    void operator()(std::deque<T> &values) {
        sized(values);
    }

    template <typename T>
    void operator()(std::optional<T> &value) {
        bool has = value.has_value();
        (*this)(has);
        T inside = value.value_or(T{});
        (*this)(inside);
        value = has ? std::optional<T>(inside) : std::nullopt;
    }

    /// What was saved.
    const std::vector<std::uint8_t> &bytes() const { return bytes_; }

    /// Throws InputError unless all bytes have been loaded.
    void require_end() const {
        if (at_ != bytes_.size()) {
            fail();
        }
    }

  private:
    [[noreturn]] static void fail() {
        throw InputError("a saved state of something else: its length differs");
    }

    void raw(void *value, std::size_t size) {
        if (!is_loading_) {
            const auto *from = static_cast<const std::uint8_t *>(value);
            bytes_.insert(bytes_.end(), from, from + size);
            return;
        }
        if (bytes_.size() - at_ < size) {
            fail();
        }
        std::memcpy(value, bytes_.data() + at_, size);
        at_ += size;
    }

    template <typename Values>
    void sized(Values &values) {
        std::uint64_t count = values.size();
        (*this)(count);
        if (count != values.size()) {
            fail();
        }
        for (auto &value : values) {
            (*this)(value);
        }
    }

    std::vector<std::uint8_t> bytes_;
    bool is_loading_ = false;
    std::size_t at_ = 0;
};

} // namespace quiesce

#endif
