/// Mounts between places: their forces, what they do to a structure, and what mistakes in a plant
/// file are answered with.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "equations.h"
#include "file_mistakes.h"
#include "mounts.h"
#include "plant_file.h"

namespace {

using quiesce::ContactMount;
using quiesce::Equations;
using quiesce::expect_message;
using quiesce::GappedMount;
using quiesce::Mistake;
using quiesce::PlantModel;
using quiesce::read;
using quiesce::SofteningMount;
using quiesce::spoilt;
using quiesce::TemporaryFile;

const char *const kMachine = "sim_hil/data/plants/isolated_machine.toml";

PlantModel loaded(const std::string &text) {
    const TemporaryFile file(text);
    return quiesce::load_plant(file.path());
}

PlantModel changed(const char *from, const char *to) {
    return loaded(spoilt(read(kMachine), {"", from, to, ""}));
}

TEST(GappedMount, touches_beyond_its_gap_only_and_on_both_sides) {
    const GappedMount mount(1e-3, 1e5, 0.0);
    for (const double free_m : {-1e-3, -5e-4, 0.0, 1e-3}) {
        EXPECT_EQ(mount.force_N(free_m, 1.0), 0.0) << free_m;
    }
    EXPECT_DOUBLE_EQ(mount.force_N(1.5e-3, 0.0), 50.0);
    EXPECT_DOUBLE_EQ(mount.force_N(-1.5e-3, 0.0), -50.0);
}

TEST(GappedMount, drags_what_comes_and_never_pulls_what_leaves) {
    const GappedMount mount(1e-3, 1e5, 200.0);
    EXPECT_DOUBLE_EQ(mount.force_N(1.5e-3, 0.1), 70.0);
    EXPECT_DOUBLE_EQ(mount.force_N(1.5e-3, -0.1), 30.0);
    EXPECT_EQ(mount.force_N(1.5e-3, -10.0), 0.0);
    EXPECT_DOUBLE_EQ(mount.force_N(-1.5e-3, -0.1), -70.0);
    EXPECT_EQ(mount.force_N(-1.5e-3, 10.0), 0.0);
    EXPECT_EQ(mount.force_N(0.0, 10.0), 0.0);
}

TEST(ContactMount, presses_and_lifts_off_where_it_would_pull) {
    const ContactMount mount(1e5, 100.0, 300.0);
    EXPECT_DOUBLE_EQ(mount.force_N(-1e-2, 0.0), -1000.0);
    EXPECT_DOUBLE_EQ(mount.force_N(1e-3, -0.5), 50.0);
    EXPECT_DOUBLE_EQ(mount.force_N(3e-3, 0.0), 300.0);
    EXPECT_EQ(mount.force_N(1.0, 10.0), 300.0); // its weight is all that draws it back
    EXPECT_EQ(mount.force_N(0.0, 0.0), 0.0);
}

TEST(SofteningMount, is_a_spring_at_rest_and_tends_to_its_limit) {
    const SofteningMount mount(2e4, 10.0);
    EXPECT_NEAR(mount.force_N(1e-6, 0.0), 2e-2, 1e-7);
    EXPECT_NEAR(mount.force_N(5e-4, 0.0), 10.0 * std::tanh(1.0), 1e-12);
    EXPECT_DOUBLE_EQ(mount.force_N(-5e-4, 3.0), -mount.force_N(5e-4, -3.0));
    EXPECT_NEAR(mount.force_N(1.0, 0.0), 10.0, 1e-9);
}

/// The rates of the machine's plant, displaced by these two metres, at rest and without current.
std::vector<double> accel_of(const PlantModel &model, double machine_m, double raft_m) {
    // eta = Phi' M q, the inverse of q = Phi eta for mass-normalised shapes.
    std::vector<double> y(Equations(model).state_count(), 0.0);
    for (Eigen::Index i = 0; i < 2; ++i) {
        y[static_cast<std::size_t>(i)] =
            20.0 * model.places[0].shape[i] * machine_m + 60.0 * model.places[1].shape[i] * raft_m;
    }
    std::vector<double> rates(y.size());
    Equations(model).rates(0.0, {}, y, rates);
    return {model.places[0].shape[0] * rates[2] + model.places[0].shape[1] * rates[3],
            model.places[1].shape[0] * rates[2] + model.places[1].shape[1] * rates[3]};
}

TEST(Mounts, push_both_ends_with_opposite_forces) {
    const PlantModel with = quiesce::load_plant(kMachine);
    PlantModel without = with;
    without.mounts.clear();
    ASSERT_EQ(with.mounts.size(), 1u);
    const auto inside = accel_of(with, 5e-4, 0.0);
    EXPECT_EQ(inside, accel_of(without, 5e-4, 0.0)) << "within the gap";
    const auto touching = accel_of(with, 1.8e-3, 0.0);
    const auto free = accel_of(without, 1.8e-3, 0.0);
    const double force_N = 140000.0 * 1e-3;
    EXPECT_NEAR(touching[0] - free[0], -force_N / 20.0, 1e-9);
    EXPECT_NEAR(touching[1] - free[1], force_N / 60.0, 1e-9);
}

TEST(Mounts, a_stiff_one_asks_for_shorter_steps) {
    const PlantModel model = quiesce::load_plant(kMachine);
    PlantModel without = model;
    without.mounts.clear();
    EXPECT_LT(longest_safe_step_s(model), longest_safe_step_s(without));
    expect_message(
        spoilt(read(kMachine), {"", "stiffness_N_m = 140000.0", "stiffness_N_m = 1e9", ""}),
        "integration", quiesce::load_plant);
}

TEST(MountFile, both_kinds_are_read_and_ground_is_an_end) {
    const PlantModel model =
        changed("kind = \"gap\"\ngap_m = 0.0008\nstiffness_N_m = 140000.0\ndamping_N_s_m = 400.0",
                "kind = \"softening\"\nstiffness_N_m = 1000.0\nlimit_N = 5.0\n[[mount]]\n"
                "a = \"ground\"\nb = \"raft\"\nkind = \"gap\"\ngap_m = 0\nstiffness_N_m = 10");
    ASSERT_EQ(model.mounts.size(), 2u);
    EXPECT_NEAR(model.mounts[0].mount->force_N(1.0, 0.0), 5.0, 1e-9);
    EXPECT_EQ(model.mounts[1].stroke, -model.places[1].shape);
    EXPECT_DOUBLE_EQ(model.mounts[1].mount->force_N(0.5, 0.0), 5.0)
        << "no drag, where none is said";
}

TEST(MountFile, a_contact_is_read) {
    const PlantModel model =
        changed("kind = \"gap\"\ngap_m = 0.0008\nstiffness_N_m = 140000.0\ndamping_N_s_m = 400.0",
                "kind = \"contact\"\nstiffness_N_m = 1000.0\npreload_N = 5.0");
    ASSERT_EQ(model.mounts.size(), 1u);
    EXPECT_DOUBLE_EQ(model.mounts[0].mount->force_N(1.0, 0.0), 5.0);
    EXPECT_DOUBLE_EQ(model.mounts[0].mount->force_N(-1.0, 7.0), -1000.0);
}

TEST(MountFile, mistakes_name_line_and_key) {
    const std::vector<Mistake> mistakes = {
        {"unknown kind", "kind = \"gap\"", "kind = \"rubber\"", "softening"},
        {"no such place", "b = \"raft\"\nkind", "b = \"roof\"\nkind", "raft"},
        {"one end", "b = \"raft\"\nkind", "b = \"machine\"\nkind", "another end"},
        {"negative gap", "gap_m = 0.0008", "gap_m = -0.0008", "gap_m"},
        {"no gap", "gap_m = 0.0008\n", "", "gap_m"},
        {"infinite", "stiffness_N_m = 140000.0", "stiffness_N_m = inf", "stiffness_N_m"},
        {"text", "damping_N_s_m = 400.0", "damping_N_s_m = \"400\"", "damping_N_s_m"},
        {"unknown key", "gap_m = 0.0008", "gap_m = 0.0008\nlimit_N = 3.0", "limit_N"},
        {"no limit", "kind = \"gap\"\ngap_m = 0.0008", "kind = \"softening\"", "limit_N"},
        {"no weight", "kind = \"gap\"\ngap_m = 0.0008", "kind = \"contact\"", "preload_N"},
        {"no table", "[[mount]]\n", "[mount]\n", "mount"},
    };
    for (const Mistake &mistake : mistakes) {
        SCOPED_TRACE(mistake.name);
        expect_message(spoilt(read(kMachine), mistake), mistake.words, quiesce::load_plant);
    }
    std::string many = read(kMachine);
    for (int i = 0; i < 4; ++i) {
        many += "[[mount]]\na = \"raft\"\nb = \"ground\"\nkind = \"gap\"\ngap_m = 0\n"
                "stiffness_N_m = 1\n";
    }
    expect_message(many, "at most 4 tables [[mount]], found 5", quiesce::load_plant);
}

} // namespace
