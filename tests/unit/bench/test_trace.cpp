#include "trace.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "input_error.h"
#include "plant_file.h"
#include "reply_fields.h"
#include "scripted_link.h"
#include "tick_columns.h"

namespace {

std::string temporary(const std::string &name) {
    return (std::filesystem::temp_directory_path() /
            ("quiesce_" + std::to_string(::getpid()) + "_" + name))
        .string();
}

std::string read(const std::string &file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

TEST(Trace, is_a_json_line_and_rows_of_float64) {
    quiesce::Trace trace({"a", "b"});
    for (const double value : {1.0, -2.5, 3e100, 0.0}) {
        trace.put(value);
    }
    const std::string file = temporary("trace");
    trace.write(file);
    const std::string bytes = read(file);
    std::filesystem::remove(file);
    const std::string head = "{\"columns\":[\"a\",\"b\"],\"rows\":2}\n";
    ASSERT_EQ(bytes.substr(0, head.size()), head);
    ASSERT_EQ(bytes.size(), head.size() + 4 * sizeof(double));
    double second = 0.0;
    std::memcpy(&second, bytes.data() + head.size() + sizeof(double), sizeof second);
    EXPECT_EQ(second, -2.5);
}

TEST(Trace, leaves_a_pipe_what_it_is) {
    const std::string pipe = temporary("pipe");
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
    ASSERT_GE(reader, 0);
    quiesce::Trace({"a"}).write(pipe);
    char first = 0;
    EXPECT_EQ(::read(reader, &first, 1), 1);
    EXPECT_EQ(first, '{');
    EXPECT_TRUE(std::filesystem::is_fifo(pipe));
    ::close(reader);
    std::filesystem::remove(pipe);
}

TEST(Trace, cannot_be_written_into_a_folder_that_is_not_there) {
    const quiesce::Trace trace({"a"});
    EXPECT_THROW(trace.write("no/such/folder/trace"), quiesce::InputError);
    EXPECT_FALSE(std::filesystem::exists("no"));
}

/// The only row of a trace with these columns, by name.
std::map<std::string, double> row_of(const quiesce::TickColumns &columns,
                                     const std::vector<double> &own,
                                     const lockstep_reply_t &reply) {
    quiesce::Trace trace(columns.names());
    columns.put(own, reply, trace);
    const std::string file = temporary("row");
    trace.write(file);
    const std::string bytes = read(file);
    std::filesystem::remove(file);
    const std::vector<std::string> names = columns.names();
    std::vector<double> values(names.size());
    std::memcpy(values.data(), bytes.data() + bytes.find('\n') + 1, values.size() * sizeof(double));
    std::map<std::string, double> row;
    for (std::size_t i = 0; i < names.size(); ++i) {
        row[names[i]] = values[i];
    }
    EXPECT_EQ(row.size(), names.size()) << "a name twice";
    return row;
}

TEST(TickColumns, telemetry_keeps_signs_and_large_words) {
    lockstep_reply_t reply{};
    reply.telemetry.tick = 0xFFFFFFFFu;
    reply.telemetry.accel_um_s2 = -7;
    reply.telemetry.current_cmd_mA = 4321;
    reply.telemetry.lock_is_on = 1;
    const quiesce::TickColumns columns(
        {"own"}, quiesce::controller_columns(QUIESCE_LAW_OFF, nullptr), std::nullopt);
    const auto row = row_of(columns, {2.5}, reply);
    EXPECT_EQ(row.at("own"), 2.5);
    EXPECT_EQ(row.at("tick"), 4294967295.0);
    EXPECT_EQ(row.at("accel_um_s2"), -7.0);
    EXPECT_EQ(row.at("current_cmd_mA"), 4321.0);
    EXPECT_EQ(row.at("lock_is_on"), 1.0);
}

TEST(TickColumns, what_a_law_reports_has_its_own_names) {
    lockstep_reply_t reply{};
    for (int i = 0; i < QUIESCE_REPORT_WORDS; ++i) {
        reply.report[i] = 100 - 50 * i;
    }
    const quiesce::TickColumns phase({}, quiesce::controller_columns(QUIESCE_LAW_PHASE, nullptr),
                                     std::nullopt);
    const auto row = row_of(phase, {}, reply);
    EXPECT_EQ(row.at("adapt_state"), 100.0);
    EXPECT_EQ(row.at("trim_on_mdeg"), -50.0);
    EXPECT_EQ(row.at("trim_is_whole"), -200.0);
    EXPECT_EQ(row.count("rules_fired"), 0u);
    const quiesce::TickColumns fuzzy({}, quiesce::controller_columns(QUIESCE_LAW_FUZZY, nullptr),
                                     "rules_fired,current_fuzzy_mA");
    EXPECT_EQ(row_of(fuzzy, {}, reply),
              (std::map<std::string, double>{{"rules_fired", 50.0}, {"current_fuzzy_mA", 100.0}}));
    EXPECT_THROW(quiesce::TickColumns({}, quiesce::controller_columns(QUIESCE_LAW_OFF, nullptr),
                                      "rules_fired"),
                 quiesce::InputError);
}

TEST(ReplyFields, name_the_words_where_they_are) {
    lockstep_reply_t reply{};
    reply.current_cmd_mA[0] = 11;
    reply.telemetry.freq_uHz = 12;
    reply.telemetry.peaks[2].amp_um_s2 = 13;
    reply.telemetry.current_cmd_mA = 14;
    reply.telemetry.lock_is_on = 15;
    reply.report[7] = 16;
    const auto &fields = quiesce::reply_fields();
    ASSERT_EQ(fields.size() * 4, sizeof reply);
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const std::string name = fields[i].name;
        const std::uint32_t word = quiesce::word_of(reply, i);
        EXPECT_EQ(word == 11, name == "reply_current_cmd_mA0") << name;
        EXPECT_EQ(word == 12, name == "freq_uHz") << name;
        EXPECT_EQ(word == 13, name == "peak2_amp_um_s2") << name;
        EXPECT_EQ(word == 14, name == "current_cmd_mA") << name;
        EXPECT_EQ(word == 15, name == "lock_is_on") << name;
        EXPECT_EQ(word == 16, name == "report7") << name;
    }
}

} // namespace
