/// JSON text of what a command found. A thin wrap of nlohmann/json: its header costs every file
/// that reads it five seconds of the first build, so only json.cpp does.
#ifndef QUIESCE_JSON_H
#define QUIESCE_JSON_H

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace quiesce {

/// A value, an array or an object; an object keeps the order of its members. Doubles are written
/// with as many digits as tell them apart.
class Json {
  public:
    using Member = std::pair<const char *, Json>;

    Json(); // null
    // What stands in an object is said without naming this class. NOLINTBEGIN(google-explicit-*)
    Json(std::nullptr_t);
    Json(bool value);
    Json(double value);
    Json(const char *text);
    Json(const std::string &text);
    template <class Integer, std::enable_if_t<std::is_integral_v<Integer>, int> = 0>
    Json(Integer value) : Json(Whole<std::is_signed_v<Integer>>{value}) {}
    template <class Value>
    Json(const std::vector<Value> &values) : Json(array_of(values)) {}
    template <class Value>
    Json(const std::set<Value> &values) : Json(array_of(values)) {}
    /// An object.
    Json(std::initializer_list<Member> members);
    template <class Value>
    Json(const std::map<std::string, Value> &members) : Json(object()) {
        for (const auto &[name, value] : members) {
            set(name, value);
        }
    }
    // NOLINTEND(google-explicit-*)

    Json(const Json &other);
    Json(Json &&other) noexcept;
    Json &operator=(Json other) noexcept;
    ~Json();

    static Json array();
    static Json object();

    void push_back(const Json &value);
    /// Of an object: a new member at its end, or another value of one that it has.
    void set(const std::string &name, const Json &value);
    /// A copy. An object without such a member is the caller's mistake: std::out_of_range.
    Json at(const std::string &name) const;

    /// On one line, or indented by so many blanks.
    std::string dump(int indent = -1) const;

  private:
    template <bool IsSigned>
    struct Whole {
        std::conditional_t<IsSigned, std::int64_t, std::uint64_t> value;
    };
    template <class Values>
    static Json array_of(const Values &values) {
        Json out = array();
        for (const auto &value : values) {
            out.push_back(value);
        }
        return out;
    }
    explicit Json(Whole<true> whole);
    explicit Json(Whole<false> whole);

    std::unique_ptr<nlohmann::ordered_json> tree_;
};

/// null where there is none.
template <class Value>
Json json_or_null(const std::optional<Value> &value) {
    return value ? Json(*value) : Json();
}

} // namespace quiesce

#endif
