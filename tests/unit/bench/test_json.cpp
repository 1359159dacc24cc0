// JSON text: every kind of value, order of members, numbers that survive.
#include <limits>
#include <optional>
#include <stdexcept>

#include <gtest/gtest.h>

#include "json.h"

namespace quiesce {
namespace {

TEST(Json, writes_every_kind_of_value) {
    const Json out = {{"none", nullptr},
                      {"yes", true},
                      {"text", "a \"b\"\n"},
                      {"list", std::vector<int>{1, 2}},
                      {"set", std::set<std::uint32_t>{3, 1}},
                      {"map", std::map<std::string, double>{{"x", 0.5}}},
                      {"empty", Json::array()},
                      {"nested", {{"a", 1}}}};
    EXPECT_EQ(out.dump(), "{\"none\":null,\"yes\":true,\"text\":\"a \\\"b\\\"\\n\",\"list\":[1,2],"
                          "\"set\":[1,3],\"map\":{\"x\":0.5},\"empty\":[],\"nested\":{\"a\":1}}");
}

TEST(Json, keeps_the_order_of_members_and_replaces_a_value_in_place) {
    Json out = {{"b", 1}, {"a", 2}};
    out.set("c", 3);
    out.set("b", "new");
    EXPECT_EQ(out.dump(), R"({"b":"new","a":2,"c":3})");
    EXPECT_EQ(out.at("a").dump(), "2");
    EXPECT_THROW(out.at("d"), std::out_of_range);
}

TEST(Json, keeps_integers_whole_and_doubles_apart) {
    EXPECT_EQ(Json(std::numeric_limits<std::uint64_t>::max()).dump(), "18446744073709551615");
    EXPECT_EQ(Json(std::numeric_limits<std::int64_t>::min()).dump(), "-9223372036854775808");
    EXPECT_EQ(Json(2.0).dump(), "2.0");
    EXPECT_EQ(std::stod(Json(0.1 + 0.2).dump()), 0.1 + 0.2);
    EXPECT_EQ(Json(std::numeric_limits<double>::infinity()).dump(), "null");
}

TEST(Json, copies_are_of_their_own) {
    Json first = Json::array();
    const Json second = first;
    first.push_back(std::optional<int>(1).value());
    EXPECT_EQ(first.dump(), "[1]");
    EXPECT_EQ(second.dump(), "[]");
    EXPECT_EQ(json_or_null(std::optional<double>{}).dump(), "null");
    EXPECT_EQ(json_or_null(std::optional<double>{1.5}).dump(), "1.5");
}

TEST(Json, indents_on_request) {
    EXPECT_EQ(Json({{"a", 1}, {"b", 2}}).dump(1), "{\n \"a\": 1,\n \"b\": 2\n}");
}

} // namespace
} // namespace quiesce
