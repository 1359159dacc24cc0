/// Matrices of a structure in CSV files beside the plant's.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "file_mistakes.h"
#include "plant_file.h"

namespace {

using quiesce::PlantModel;
using quiesce::read;
using quiesce::spoilt;

const char *const kTwoStoreys = "sim_hil/data/plants/two_storeys.toml";
constexpr const char *kStiffness =
    "stiffness_N_m = [\n    [37200.0, -18600.0],\n    [-18600.0, 18600.0],\n]";

/// A folder with a plant that takes its stiffness from k.csv.
class Folder {
  public:
    explicit Folder(const std::string &csv) {
        std::filesystem::create_directories(folder_);
        std::ofstream(folder_ / "k.csv") << csv;
        write(spoilt(read(kTwoStoreys), {"", kStiffness, "stiffness_N_m_file = \"k.csv\"", ""}));
    }
    ~Folder() { std::filesystem::remove_all(folder_); }
    Folder(const Folder &) = delete;
    Folder &operator=(const Folder &) = delete;

    void write(const std::string &plant) const { std::ofstream(path()) << plant; }
    std::string path() const { return (folder_ / "plant.toml").string(); }

  private:
    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("quiesce_matrices_" + std::to_string(::getpid()));
};

std::string message_of(const std::string &csv) {
    const Folder folder(csv);
    try {
        quiesce::load_plant(folder.path());
    } catch (const quiesce::InputError &error) {
        return error.what();
    }
    return "accepted";
}

TEST(MatrixFile, is_the_matrix_that_it_holds) {
    const Folder folder("\xEF\xBB\xBF"
                        "37200, -18600\r\n\r\n-18600,1.86e4\r\n");
    const PlantModel inside = quiesce::load_plant(kTwoStoreys);
    const PlantModel beside = quiesce::load_plant(folder.path());
    EXPECT_EQ(inside.structure.omega2_rad2_s2, beside.structure.omega2_rad2_s2);
    EXPECT_EQ(inside.structure.at_sensor, beside.structure.at_sensor);
}

TEST(MatrixFile, the_example_of_five_storeys_is_read) {
    const PlantModel model = quiesce::load_plant("sim_hil/data/plants/five_storeys.toml");
    ASSERT_EQ(model.structure.mode_count(), 5);
    EXPECT_NEAR(std::sqrt(model.structure.omega2_rad2_s2[0]) / 6.283185307, 2.668, 0.01);
}

TEST(MatrixFile, mistakes_name_file_and_line) {
    EXPECT_NE(message_of("1,2\n3\n").find("k.csv:2: expected 2 numbers, found 1"),
              std::string::npos);
    EXPECT_NE(message_of("1,2\n").find("expected 2 lines of 2 numbers"), std::string::npos);
    EXPECT_NE(message_of("1,2\n3,4\n5,6\n").find("found 3 lines"), std::string::npos);
    EXPECT_NE(message_of("1,x\n3,4\n").find("k.csv:1: column 2: expected a finite number"),
              std::string::npos);
    EXPECT_NE(message_of("1,nan\n3,4\n").find("finite"), std::string::npos);
    EXPECT_NE(message_of("").find("is empty; expected lines of numbers"), std::string::npos);
    EXPECT_NE(message_of("1,2\n3,4\n").find("stiffness_N_m"), std::string::npos)
        << "not symmetric: as of one in the file";
}

TEST(MatrixFile, both_or_none_is_a_mistake) {
    const Folder folder("37200,-18600\n-18600,18600\n");
    folder.write(spoilt(read(kTwoStoreys),
                        {"", "[structure]", "[structure]\nstiffness_N_m_file = \"k.csv\"", ""}));
    EXPECT_THROW(quiesce::load_plant(folder.path()), quiesce::InputError);
    folder.write(
        spoilt(read(kTwoStoreys), {"", kStiffness, "stiffness_N_m_file = \"none.csv\"", ""}));
    EXPECT_THROW(quiesce::load_plant(folder.path()), quiesce::InputError);
}

} // namespace
