#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include <sys/resource.h>

#include "fault_latch.h"
#include "fault_store.h"
#include "temporary_folder.h"

#include "quiesce_can_tables.h"

namespace quiesced {
namespace {

TEST(FaultStore, keeps_a_fault_until_it_is_forgotten) {
    const TemporaryFolder folder;
    FaultStore store(folder.path());
    std::string note = "x";
    EXPECT_EQ(store.load(note), QUIESCE_FAULT_NONE);
    EXPECT_EQ(note, "");
    ASSERT_EQ(store.keep(QUIESCE_FAULT_COIL_OPEN), "");
    ASSERT_EQ(store.keep(QUIESCE_FAULT_ESTOP), "");
    EXPECT_EQ(store.load(note), QUIESCE_FAULT_ESTOP);
    EXPECT_EQ(note.rfind("fault ESTOP of 2", 0), 0U) << note;
    ASSERT_EQ(store.keep(QUIESCE_FAULT_NONE), "");
    ASSERT_EQ(store.keep(QUIESCE_FAULT_NONE), "");
    EXPECT_EQ(store.load(note), QUIESCE_FAULT_NONE);
    EXPECT_EQ(note, "");
}

TEST(FaultStore, a_record_that_cannot_be_read_counts_as_an_emergency_stop) {
    const TemporaryFolder folder;
    FaultStore store(folder.path());
    for (const char *damage : {"", "short", "NVM1 but nothing that follows from it"}) {
        write_text(store.file(), damage);
        std::string note;
        EXPECT_EQ(store.load(note), QUIESCE_FAULT_ESTOP);
        EXPECT_NE(note.find("its record cannot be read: "), std::string::npos) << note;
    }
    // A start keeps it as what it counts as.
    EXPECT_EQ(store.keep(QUIESCE_FAULT_ESTOP), "");
    std::string kept;
    EXPECT_EQ(store.load(kept), QUIESCE_FAULT_ESTOP);
    EXPECT_EQ(kept.rfind("fault ESTOP of 2", 0), 0U) << kept;
    EXPECT_EQ(store.keep(QUIESCE_FAULT_NONE), "");
    std::string note;
    EXPECT_EQ(store.load(note), QUIESCE_FAULT_NONE);
    EXPECT_NE(FaultStore("/no/such/folder").keep(QUIESCE_FAULT_ESTOP), "");
}

/// Of a version that wrote records aside, killed before the renaming.
TEST(FaultStore, a_leftover_counts_as_an_emergency_stop_until_it_is_forgotten) {
    const TemporaryFolder folder;
    FaultStore store(folder.path());
    ASSERT_EQ(store.keep(QUIESCE_FAULT_NONE), "");
    write_text(store.leftover(), "half of a rec");
    std::string note;
    EXPECT_EQ(store.load(note), QUIESCE_FAULT_ESTOP);
    EXPECT_NE(note.find("killed while it kept it"), std::string::npos) << note;
    ASSERT_EQ(store.keep(QUIESCE_FAULT_ESTOP), ""); // as at a start
    EXPECT_FALSE(std::filesystem::exists(store.leftover()));
    EXPECT_EQ(store.load(note), QUIESCE_FAULT_ESTOP);
}

TEST(FaultStore, a_damaged_half_of_the_record_counts_as_an_emergency_stop) {
    const TemporaryFolder folder;
    FaultStore store(folder.path());
    ASSERT_EQ(store.keep(QUIESCE_FAULT_NONE), "");
    const std::string whole = read_text(store.file());
    ASSERT_EQ(whole.size(), 8192U);
    for (const std::size_t at : {0U, 20U, 40U, 4096U, 4120U}) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 4);
        write_text(store.file(), damaged);
        std::string note;
        EXPECT_EQ(store.load(note), QUIESCE_FAULT_ESTOP) << at;
    }
}

TEST(FaultStore, a_record_needs_no_room_and_no_right_to_the_folder_once_it_is_there) {
    const TemporaryFolder folder;
    FaultStore store(folder.path());
    ASSERT_EQ(store.keep(QUIESCE_FAULT_NONE), "");
    struct rlimit before {};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit none = {8192, before.rlim_max}; // no file grows beyond it
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &none), 0);
    std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_exec);
    const std::string error = store.keep(QUIESCE_FAULT_ESTOP);
    std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    EXPECT_EQ(error, "");
    std::string note;
    EXPECT_EQ(FaultStore(folder.path()).load(note), QUIESCE_FAULT_ESTOP);
}

TEST(FaultStore, a_record_that_was_removed_is_made_again) {
    const TemporaryFolder folder;
    FaultStore store(folder.path());
    ASSERT_EQ(store.keep(QUIESCE_FAULT_NONE), "");
    std::filesystem::remove(store.file());
    ASSERT_EQ(store.keep(QUIESCE_FAULT_ESTOP), "");
    std::string note;
    EXPECT_EQ(FaultStore(folder.path()).load(note), QUIESCE_FAULT_ESTOP);
}

/// The core with a sensor and no bus, as the loop runs it.
class Rig {
  public:
    explicit Rig(std::uint32_t kept) : exchange(std::make_unique<Exchange>()) {
        exchange->latched_fault.store(kept);
        latch = std::make_unique<FaultLatch>(*exchange);
        quiesce_params_t params{};
        quiesce_params_default(&params);
        (void)node_init(node.get(), nullptr, &params, {NODE_ENABLE_BOARD, 0});
    }

    std::uint32_t tick(bool is_pressed, bool is_reset) {
        node_inputs_t inputs{};
        inputs.enable = count_ > 0 && !is_reset; // its edge arms
        inputs.estop = is_pressed;
        inputs.fault_reset = is_reset;
        inputs.ticks_elapsed = 1;
        inputs.sensor[0] = {count_++ % 7, true, false};
        latch->before_tick(inputs);
        can_frame_t frames[NODE_MAX_FRAMES];
        (void)node_tick(node.get(), &inputs, frames);
        latch->after_tick(*node);
        is_driver_enabled = node->out.damper[0].driver_enable;
        return node->out.telemetry.state;
    }

    std::uint32_t kept() const { return exchange->latched_fault.load(); }

    std::unique_ptr<Exchange> exchange;
    std::unique_ptr<FaultLatch> latch;
    std::unique_ptr<node_t> node = std::make_unique<node_t>();
    bool is_driver_enabled = false;

  private:
    std::int32_t count_ = 0;
};

TEST(FaultLatch, without_a_kept_fault_the_core_starts) {
    Rig rig(QUIESCE_FAULT_NONE);
    EXPECT_FALSE(rig.latch->is_holding());
    EXPECT_EQ(rig.tick(false, false), QUIESCE_STATE_SELF_TEST);
    EXPECT_FALSE(rig.is_driver_enabled);
    for (int i = 0; i < 300; ++i) {
        (void)rig.tick(false, false);
    }
    EXPECT_TRUE(rig.is_driver_enabled);
    EXPECT_EQ(rig.kept(), QUIESCE_FAULT_NONE);
}

TEST(FaultLatch, a_kept_fault_holds_from_the_first_tick_until_one_edge) {
    Rig rig(QUIESCE_FAULT_COIL_OPEN);
    for (int i = 0; i < 100; ++i) {
        EXPECT_TRUE(rig.latch->is_holding());
        ASSERT_EQ(rig.tick(false, false), QUIESCE_STATE_FAULT);
        ASSERT_FALSE(rig.is_driver_enabled);
    }
    EXPECT_EQ(rig.kept(), QUIESCE_FAULT_COIL_OPEN);
    // The button stays pressed: one edge.
    EXPECT_EQ(rig.tick(false, true), QUIESCE_STATE_FAULT);
    EXPECT_EQ(rig.tick(false, true), QUIESCE_STATE_FAULT);
    EXPECT_EQ(rig.kept(), QUIESCE_FAULT_COIL_OPEN);
    EXPECT_EQ(rig.tick(false, true), QUIESCE_STATE_INIT);
    EXPECT_EQ(rig.kept(), QUIESCE_FAULT_NONE);
    EXPECT_EQ(rig.latch->held(), QUIESCE_FAULT_NONE);
}

TEST(FaultLatch, a_button_that_is_stuck_acknowledges_nothing) {
    Rig rig(QUIESCE_FAULT_ESTOP);
    for (int i = 0; i < 100; ++i) {
        ASSERT_EQ(rig.tick(false, true), QUIESCE_STATE_FAULT);
    }
    EXPECT_TRUE(rig.latch->is_holding());
}

TEST(FaultLatch, a_pressed_stop_is_not_acknowledged) {
    Rig rig(QUIESCE_FAULT_ESTOP);
    (void)rig.tick(true, false);
    (void)rig.tick(true, true);
    EXPECT_TRUE(rig.latch->is_holding());
    EXPECT_EQ(rig.kept(), QUIESCE_FAULT_ESTOP);
}

TEST(FaultLatch, a_stop_on_the_bus_is_not_acknowledged) {
    Rig rig(QUIESCE_FAULT_ESTOP);
    (void)rig.tick(false, false);
    can_frame_t stop{QUIESCE_CAN_EMERGENCY_STOP_FRAME_ID, 4, false, false, {0xA5, 0x5A, 0, 0}};
    std::uint8_t alive = 0;
    e2e_protect(&quiesce_can_messages[QUIESCE_CAN_AT_EMERGENCY_STOP].e2e, &alive, &stop);
    node_receive(rig.node.get(), &stop);
    (void)rig.tick(false, true);
    ASSERT_TRUE(rig.node->bus.estop);
    EXPECT_TRUE(rig.latch->is_holding());
}

TEST(FaultLatch, a_stop_right_after_the_acknowledgement_is_kept) {
    Rig rig(QUIESCE_FAULT_COIL_OPEN);
    (void)rig.tick(false, false);
    (void)rig.tick(false, true);
    for (int i = 0; i < 10; ++i) {
        ASSERT_EQ(rig.tick(true, false), QUIESCE_STATE_FAULT);
    }
    EXPECT_EQ(rig.kept(), QUIESCE_FAULT_ESTOP);
}

TEST(FaultLatch, a_fault_of_this_run_is_kept_until_it_is_acknowledged) {
    Rig rig(QUIESCE_FAULT_NONE);
    (void)rig.tick(false, false);
    (void)rig.tick(true, false);
    EXPECT_EQ(rig.kept(), QUIESCE_FAULT_ESTOP);
    (void)rig.tick(false, false);
    EXPECT_EQ(rig.kept(), QUIESCE_FAULT_ESTOP);
    EXPECT_EQ(rig.tick(false, true), QUIESCE_STATE_INIT);
    EXPECT_EQ(rig.kept(), QUIESCE_FAULT_NONE);
}

} // namespace
} // namespace quiesced
