#include <gtest/gtest.h>

#include <unistd.h>

#include "histogram.h"
#include "input_error.h"
#include "instance_lock.h"
#include "names.h"
#include "nvm_file.h"
#include "state_store.h"
#include "status_file.h"
#include "temporary_folder.h"

namespace quiesced {
namespace {

quiesce_params_t params_with(std::int32_t constant_current_mA) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.constant_current_mA = constant_current_mA;
    return params;
}

TEST(StateStore, without_saved_parameters_the_configuration_counts) {
    const TemporaryFolder folder;
    std::string note = "x";
    EXPECT_EQ(StateStore(folder.path()).effective(params_with(1), note).constant_current_mA, 1);
    EXPECT_EQ(note, "");
}

TEST(StateStore, saved_parameters_win_until_the_configuration_changes) {
    const TemporaryFolder folder;
    StateStore store(folder.path());
    std::string note;
    ASSERT_EQ(store.save_params(params_with(1), params_with(2)), "");
    EXPECT_EQ(store.effective(params_with(1), note).constant_current_mA, 2);
    EXPECT_EQ(note, "saved parameters are used");
    EXPECT_EQ(store.effective(params_with(3), note).constant_current_mA, 3);
    EXPECT_EQ(note, "saved parameters are not used: [parameters] has changed since");
}

TEST(StateStore, parameters_that_a_check_refuses_are_not_used) {
    const TemporaryFolder folder;
    StateStore store(folder.path());
    std::string note;
    ASSERT_EQ(store.save_params(params_with(1), params_with(-7)), "");
    EXPECT_EQ(store.effective(params_with(1), note).constant_current_mA, 1);
    EXPECT_EQ(note.rfind("saved parameters are not used: constant_current_mA: ", 0), 0U) << note;
}

TEST(StateStore, parameters_of_another_release_are_not_used) {
    const TemporaryFolder folder;
    StateStore store(folder.path());
    struct {
        std::uint32_t configured_hash;
        quiesce_params_t params;
    } const saved = {0, params_with(2)};
    linux_error_t error{};
    for (const std::uint32_t version : {1U, QUIESCE_PARAM_LAYOUT ^ 1U}) {
        ASSERT_TRUE(nvm_file_write(store.params_file().c_str(), "param", version, &saved,
                                   sizeof saved, &error));
        std::string note;
        EXPECT_EQ(store.effective(params_with(1), note).constant_current_mA, 1);
        EXPECT_NE(note.find("another version"), std::string::npos) << note;
    }
}

TEST(StateStore, a_damaged_record_is_told_and_left_where_it_is) {
    const TemporaryFolder folder;
    StateStore store(folder.path());
    std::string note;
    for (const char *damage : {"", "short", "QUIESCE but nothing that follows from it"}) {
        write_text(store.params_file(), damage);
        EXPECT_EQ(store.effective(params_with(1), note).constant_current_mA, 1);
        EXPECT_EQ(note.rfind("saved parameters are not used: ", 0), 0U) << note;
        EXPECT_EQ(read_text(store.params_file()), damage);
    }
}

TEST(StateStore, a_folder_that_is_gone_is_an_error_not_an_end) {
    StateStore store("/no/such/folder");
    EXPECT_NE(store.save_params(params_with(1), params_with(1)), "");
    EXPECT_NE(replace_file(store.status_file(), "x"), "");
}

TEST(InstanceLock, makes_its_folder_and_holds_it) {
    const TemporaryFolder folder;
    const std::string inner = folder / "state";
    EXPECT_EQ(InstanceLock::holder(inner), 0);
    {
        const InstanceLock lock(inner);
        EXPECT_EQ(InstanceLock::holder(inner), getpid());
        EXPECT_THROW(InstanceLock{inner}, quiesce::InputError);
    }
    EXPECT_EQ(InstanceLock::holder(inner), 0);
    const InstanceLock again(inner);
}

TEST(InstanceLock, a_folder_that_cannot_be_made_is_refused) {
    EXPECT_THROW(InstanceLock("/proc/none/such"), quiesce::InputError);
    const TemporaryFolder folder;
    write_text(folder / "file", "");
    EXPECT_THROW(InstanceLock(folder / "file"), quiesce::InputError);
}

TEST(InstanceLock, does_not_follow_a_link_out_of_its_folder) {
    const TemporaryFolder folder;
    write_text(folder / "victim", "precious");
    ASSERT_EQ(symlink((folder / "victim").c_str(), (folder / "lock").c_str()), 0);
    EXPECT_THROW(InstanceLock{folder.path()}, quiesce::InputError);
    EXPECT_EQ(read_text(folder / "victim"), "precious");
}

TEST(StatusFile, is_replaced_as_a_whole) {
    const TemporaryFolder folder;
    const std::string file = folder / "state.json";
    EXPECT_EQ(replace_file(file, "first"), "");
    EXPECT_EQ(replace_file(file, "second"), "");
    EXPECT_EQ(read_text(file), "second");
    EXPECT_FALSE(std::filesystem::exists(file + ".new"));
}

TEST(StatusFile, a_disk_without_room_leaves_the_old_one) {
    const TemporaryFolder folder;
    const std::string file = folder / "state.json";
    EXPECT_EQ(replace_file(file, "first"), "");
    std::filesystem::create_directory(file + ".new");
    EXPECT_NE(replace_file(file, "second"), "");
    EXPECT_EQ(read_text(file), "first");
}

TEST(StatusFile, names_state_fault_and_counters) {
    Snapshot snapshot{};
    snapshot.telemetry.state = QUIESCE_STATE_FAULT;
    snapshot.telemetry.fault = QUIESCE_FAULT_ESTOP;
    snapshot.faults[0] = {QUIESCE_FAULT_ESTOP, 17, 0, 2};
    snapshot.bus.tx_dropped = 5;
    const std::string json = status_json(Config(), snapshot);
    for (const char *part : {"\"state\": \"FAULT\"", "\"fault\": \"ESTOP\"", "\"tx_dropped\": 5",
                             "\"last_faults\": [{\"fault\": \"ESTOP\", \"tick\": 17, \"time\": "
                             "\"1970-01-01T00:00:00",
                             "\"times\": 2}],"}) {
        EXPECT_NE(json.find(part), std::string::npos) << part << " in\n" << json;
    }
}

TEST(Names, numbers_without_a_name_have_none) {
    EXPECT_STREQ(state_name(2), "RUN");
    EXPECT_STREQ(state_name(99), "?");
    EXPECT_STREQ(fault_name(QUIESCE_FAULT_SENSOR_QUIET), "SENSOR_QUIET");
    EXPECT_STREQ(fault_name(99), "?");
}

TEST(Histogram, leaves_empty_bins_out) {
    tick_histogram_t histogram{};
    histogram.count = 3;
    histogram.total_ns = 33'000;
    histogram.worst_ns = 21'500;
    histogram.bins[0] = 1; // below 1 us
    histogram.bins[5] = 2; // 16 .. 32 us
    EXPECT_EQ(histogram_line(histogram), "3 ticks, mean 11.0 us, worst 21.5 us; <1us 1, <32us 2");
    EXPECT_EQ(histogram_json(histogram), "{\"count\": 3, \"mean_us\": 11.0, \"worst_us\": 21.5, "
                                         "\"below_us\": {\"1\": 1, \"32\": 2}}");
}

} // namespace
} // namespace quiesced
