#include "trace.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "input_error.h"
#include "plant_file.h"
#include "reply_fields.h"
#include "scripted_link.h"

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

std::size_t column_of(const std::string &name) {
    const auto &fields = quiesce::telemetry_fields();
    std::size_t i = 0;
    while (fields.at(i).name != name) {
        ++i;
    }
    return i;
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

TEST(Trace, cannot_be_written_into_a_folder_that_is_not_there) {
    const quiesce::Trace trace({"a"});
    EXPECT_THROW(trace.write("no/such/folder/trace"), quiesce::InputError);
    EXPECT_FALSE(std::filesystem::exists("no"));
}

TEST(Trace, telemetry_keeps_signs_and_large_words) {
    quiesce::Trace trace(quiesce::with_telemetry_columns({}));
    quiesce_telemetry_t telemetry{};
    telemetry.tick = 0xFFFFFFFFu;
    telemetry.accel_um_s2 = -7;
    telemetry.current_cmd_mA = 4321;
    telemetry.lock_is_on = 1;
    telemetry.adapt_trials = 0x80000000u;
    telemetry.trim_on_mdeg = -45000;
    telemetry.trim_level_q15 = -16384;
    trace.put_telemetry(telemetry);
    const std::string file = temporary("telemetry");
    trace.write(file);
    const std::string bytes = read(file);
    std::filesystem::remove(file);
    std::vector<double> row(quiesce::telemetry_fields().size());
    std::memcpy(row.data(), bytes.data() + bytes.find('\n') + 1, row.size() * sizeof(double));
    EXPECT_EQ(row.front(), 4294967295.0);
    EXPECT_EQ(row[5], -7.0);
    EXPECT_EQ(row[column_of("current_cmd_mA")], 4321.0);
    EXPECT_EQ(row[column_of("lock_is_on")], 1.0);
    EXPECT_EQ(row[column_of("adapt_trials")], 2147483648.0);
    EXPECT_EQ(row[column_of("trim_on_mdeg")], -45000.0);
    EXPECT_EQ(row[column_of("trim_level_q15")], -16384.0);
}

TEST(ReplyFields, name_the_words_where_they_are) {
    lockstep_reply_t reply{};
    reply.current_cmd_mA = 11;
    reply.telemetry.freq_uHz = 12;
    reply.telemetry.peaks[2].amp_um_s2 = 13;
    reply.telemetry.current_cmd_mA = 14;
    reply.telemetry.adapt_state = 15;
    reply.telemetry.trim_off_mdeg = 16;
    const auto &fields = quiesce::reply_fields();
    ASSERT_EQ(fields.size() * 4, sizeof reply);
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const std::string name = fields[i].name;
        const std::uint32_t word = quiesce::word_of(reply, i);
        EXPECT_EQ(word == 11, name == "reply_current_cmd_mA") << name;
        EXPECT_EQ(word == 12, name == "freq_uHz") << name;
        EXPECT_EQ(word == 13, name == "peak2_amp_um_s2") << name;
        EXPECT_EQ(word == 14, name == "current_cmd_mA") << name;
        EXPECT_EQ(word == 15, name == "adapt_state") << name;
        EXPECT_EQ(word == 16, name == "trim_off_mdeg") << name;
    }
}

} // namespace
