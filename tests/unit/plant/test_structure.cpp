#include "structure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "input_error.h"

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using quiesce::InputError;
using quiesce::Matrices;
using quiesce::Structure;

constexpr double kPi = 3.14159265358979323846;

/// Two equal masses between three equal springs: omega^2 = k/m and 3 k/m.
Matrices chain() {
    Matrices out;
    out.mass_kg = 2.0 * Matrix2d::Identity();
    out.stiffness_N_m = (Matrix2d() << 200.0, -100.0, -100.0, 200.0).finished();
    out.damping_N_s_m = 0.4 * Matrix2d::Identity();
    out.force = Vector2d(1.0, 0.0);
    out.sensor = Vector2d(0.0, 1.0);
    out.base = Vector2d::Ones();
    return out;
}

TEST(Structure, modes_become_si) {
    const Structure structure = quiesce::structure_from_modes({{11.5, 0.0752174, 0.17, 4.5}});
    EXPECT_NEAR(structure.omega2_rad2_s2[0], 5221.0, 1.0);
    EXPECT_NEAR(structure.damping_1_s(0, 0), 2.0 * kPi * 1.73, 1e-5);
    EXPECT_EQ(structure.at_force[0], 0.17);
    EXPECT_EQ(structure.at_sensor[0], 4.5);
    EXPECT_TRUE(structure.is_proportional);
}

TEST(Structure, matrices_give_the_known_modes_of_a_chain) {
    const Structure structure = quiesce::structure_from_matrices(chain(), 2);
    EXPECT_NEAR(structure.omega2_rad2_s2[0], 50.0, 1e-9);
    EXPECT_NEAR(structure.omega2_rad2_s2[1], 150.0, 1e-9);
    EXPECT_TRUE(structure.is_proportional);
    EXPECT_NEAR(structure.damping_1_s(0, 0), 0.2, 1e-12);
    EXPECT_NEAR(structure.shape_of(Vector2d(-1.0, 1.0))[0], 0.0, 1e-12)
        << "both masses move alike in mode 1";
    EXPECT_NEAR(std::abs(structure.at_force[0]), 0.5, 1e-12) << "1/sqrt(total mass)";
    EXPECT_NEAR(structure.at_force[1] * structure.at_sensor[1], -0.25, 1e-12);
}

TEST(Structure, base_participation_comes_from_mass_and_influence) {
    Matrices matrices = chain();
    Structure structure = quiesce::structure_from_matrices(matrices, 2);
    // Both masses of 2 kg move with the base: all of it is felt by mode 1, where both move alike.
    EXPECT_NEAR(std::abs(structure.base_participation[0]), 2.0, 1e-12);
    EXPECT_NEAR(structure.base_participation[1], 0.0, 1e-12);
    EXPECT_NEAR(structure.base_participation[0] * structure.at_sensor[0], 1.0, 1e-12);
    EXPECT_EQ(structure.base_at_sensor, 1.0);
    matrices.base = Vector2d(0.0, 0.5);
    structure = quiesce::structure_from_matrices(matrices, 2);
    EXPECT_NEAR(structure.base_participation.squaredNorm(), 2.0 * 0.25, 1e-12);
    EXPECT_EQ(structure.base_at_sensor, 0.5);
}

TEST(Structure, fewer_modes_keep_the_lowest) {
    const Structure structure = quiesce::structure_from_matrices(chain(), 1);
    ASSERT_EQ(structure.mode_count(), 1);
    EXPECT_NEAR(structure.omega2_rad2_s2[0], 50.0, 1e-9);
}

TEST(Structure, damping_that_couples_modes_is_kept_in_full) {
    Matrices matrices = chain();
    matrices.damping_N_s_m = (Matrix2d() << 0.4, 0.0, 0.0, 0.0).finished();
    const Structure structure = quiesce::structure_from_matrices(matrices, 2);
    EXPECT_FALSE(structure.is_proportional);
    EXPECT_NEAR(std::abs(structure.damping_1_s(0, 1)), 0.1, 1e-12);
    EXPECT_EQ(structure.damping_1_s(0, 1), structure.damping_1_s(1, 0));
}

void expect_refused(const Matrices &matrices, const std::string &words) {
    try {
        quiesce::structure_from_matrices(matrices, 2);
        FAIL() << "accepted, expected: " << words;
    } catch (const InputError &error) {
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
}

TEST(Structure, impossible_matrices_are_refused_by_name) {
    Matrices matrices = chain();
    matrices.mass_kg(0, 0) = -1.0;
    expect_refused(matrices, "mass_kg: expected a positive definite");
    matrices = chain();
    matrices.mass_kg(0, 1) = 0.5;
    expect_refused(matrices, "mass_kg: expected a symmetric");
    matrices = chain();
    matrices.stiffness_N_m(0, 0) = -200.0;
    expect_refused(matrices, "stiffness_N_m: expected no negative eigenvalue");
    matrices = chain();
    matrices.damping_N_s_m(1, 1) = -0.1;
    expect_refused(matrices, "damping_N_s_m: expected no negative eigenvalue");
}

} // namespace
