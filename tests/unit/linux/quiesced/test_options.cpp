#include <gtest/gtest.h>

#include "input_error.h"
#include "options.h"

namespace quiesced {
namespace {

TEST(Options, defaults) {
    const Options options = parse_options({});
    EXPECT_EQ(options.mode, Mode::run);
    EXPECT_EQ(options.config_file, "/etc/quiesced/quiesced.toml");
    EXPECT_EQ(options.ticks, 0U);
}

TEST(Options, all_are_read) {
    EXPECT_EQ(parse_options({"--config", "a", "--check"}).config_file, "a");
    EXPECT_EQ(parse_options({"--check"}).mode, Mode::check);
    EXPECT_EQ(parse_options({"--make-safe"}).mode, Mode::make_safe);
    EXPECT_EQ(parse_options({"--lockstep"}).mode, Mode::lockstep);
    EXPECT_EQ(parse_options({"--clear-fault"}).mode, Mode::clear_fault);
    EXPECT_EQ(parse_options({"--version"}).mode, Mode::version);
    EXPECT_EQ(parse_options({"-h"}).mode, Mode::help);
    EXPECT_EQ(parse_options({"--ticks", "12"}).ticks, 12U);
}

class WrongOptions : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(WrongOptions, are_refused) {
    EXPECT_THROW(parse_options(GetParam()), quiesce::InputError);
}

INSTANTIATE_TEST_SUITE_P(
    Options, WrongOptions,
    testing::Values(std::vector<std::string>{"--chek"}, std::vector<std::string>{"file"},
                    std::vector<std::string>{""}, std::vector<std::string>{"--config"},
                    std::vector<std::string>{"--config", ""},
                    std::vector<std::string>{"--check", "--lockstep"},
                    std::vector<std::string>{"--make-safe", "--clear-fault"},
                    std::vector<std::string>{"--ticks", "0"},
                    std::vector<std::string>{"--ticks", "-1"},
                    std::vector<std::string>{"--ticks", "1x"},
                    std::vector<std::string>{"--ticks", "99999999999999999999"},
                    std::vector<std::string>{"--ticks", "5", "--check"}));

} // namespace
} // namespace quiesced
