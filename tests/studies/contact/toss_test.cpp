// The reader of recorded tosses.
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <gtest/gtest.h>

#include "shared/base/files.hpp"
#include "tests/studies/contact/generated_testing.h"

namespace kaz::contact {
namespace {

constexpr const char* kGoodLine = "1,2,3,1,0,0,0,0.5,0,-1,0,0,4\n";

std::string lines(int count, const std::string& line = kGoodLine) {
  std::string text;
  for (int i = 0; i < count; ++i) text += line;
  return text;
}

class TossFiles : public testing::Test {
 protected:
  void SetUp() override { folder_ = make_temporary_folder("toss").value(); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) const {
    EXPECT_TRUE(write_whole_file(folder_ + "/" + name, text));
    return folder_ + "/" + name;
  }
  void expect_error(const std::string& name, const std::string& text, const std::string& part) {
    const auto toss = read_toss(write(name, text));
    ASSERT_FALSE(toss) << part;
    EXPECT_EQ(toss.error().fault, Fault::usage);
    EXPECT_NE(toss.error().message.find(part), std::string::npos) << toss.error().message;
  }
  std::string folder_;
};

TEST_F(TossFiles, AreReadInMetersAndWorldAxes) {
  const std::string turned = "1,2,3,0.70710678,0,0.70710678,0,0.5,0,-1,0,0,4\n";
  const auto toss = read_toss(write("012.csv", lines(10, turned)));
  ASSERT_TRUE(toss) << toss.error().message;
  EXPECT_EQ(toss->number, 12);
  ASSERT_EQ(toss->path.size(), 10U);
  EXPECT_NEAR(toss->path[0].at.z(), 3 * 0.0524, 1e-12);
  EXPECT_NEAR(toss->velocity[9].z(), -0.0524, 1e-12);
  // A quarter turn about y takes the body's z axis to the world's x axis.
  EXPECT_TRUE(toss->spin[0].isApprox(Eigen::Vector3d(4, 0, 0), 1e-7));
}

TEST_F(TossFiles, WithBadLinesAreRejectedWithTheirLine) {
  expect_error("0.csv", lines(9) + "1,2,3\n", "0.csv:10: has 3 columns; must have 13");
  expect_error("0.csv", lines(9) + "1,2,3,1,0,0,0,0.5,0,-1,0,0,x\n",
               ":10: column 13 is 'x': must be a number from -500 to 500");
  expect_error("0.csv", lines(9) + "nan,2,3,1,0,0,0,0.5,0,-1,0,0,0\n", ":10: column 1 is 'nan'");
  expect_error("0.csv", lines(9) + "2000,2,3,1,0,0,0,0.5,0,-1,0,0,0\n",
               "must be a number from -1000 to 1000");
  expect_error("0.csv", lines(9) + "1,2,3,0.9,0,0,0,0.5,0,-1,0,0,0\n",
               ":10: the quaternion in columns 4 to 7 has the length 0.9");
  expect_error("0.csv", lines(4) + "\n" + lines(9), "0.csv:5: has 1 columns");
}

TEST_F(TossFiles, WithBadNamesOrLengthsAreRejected) {
  expect_error("first.csv", lines(10), "the name of a toss must be NUMBER.csv");
  expect_error("-2.csv", lines(10), "the name of a toss must be NUMBER.csv");
  expect_error("1.csv", lines(9), "has 9 samples; a toss needs at least 10");
  expect_error("1.csv", lines(10001), "1.csv:10001: a toss has at most 10,000 samples");
}

TEST_F(TossFiles, OfAFolderAreSortedByNumber) {
  for (const int number : {10, 9, 8, 7, 6, 5, 4, 100})
    write(std::to_string(number) + ".csv", lines(10));
  write("README.txt", "not a toss");
  const auto tosses = read_tosses(folder_);
  ASSERT_TRUE(tosses) << tosses.error().message;
  ASSERT_EQ(tosses->size(), 8U);
  EXPECT_EQ(tosses->front().number, 4);
  EXPECT_EQ(tosses->back().number, 100);
  write("0100.csv", lines(10));
  EXPECT_NE(read_tosses(folder_).error().message.find("the toss 100 occurs twice"),
            std::string::npos);
}

TEST_F(TossFiles, AreMissingInOtherFolders) {
  EXPECT_NE(read_tosses(folder_).error().message.find("has 0 files NUMBER.csv"), std::string::npos);
  EXPECT_NE(read_tosses(folder_ + "/none").error().message.find("give a folder of tosses"),
            std::string::npos);
}

TEST_F(TossFiles, AreWrittenAsTheyAreRead) {
  const auto engine = kaz_engine("reduced", 4);
  ASSERT_TRUE(engine);
  const Toss toss = test::generated_tosses(*engine, engine->start(), 1, 20)[0];
  ASSERT_TRUE(write_toss(folder_, toss));
  const auto read = read_toss(folder_ + "/0.csv");
  ASSERT_TRUE(read) << read.error().message;
  for (std::size_t i = 0; i < toss.path.size(); ++i) {
    EXPECT_TRUE(read->path[i].at.isApprox(toss.path[i].at, 1e-7));
    EXPECT_LT(read->path[i].turn.angularDistance(toss.path[i].turn), 1e-7);
    EXPECT_TRUE(read->spin[i].isApprox(toss.spin[i], 1e-7));
  }
}

TEST_F(TossFiles, HaveVelocitiesOfHalfASampleEarlier) {
  // A fall: the difference to the previous position is the velocity at half a sample before.
  Toss fall;
  fall.path.resize(10);
  for (std::size_t i = 0; i < 10; ++i) {
    const double time = static_cast<double>(i) / kRate;
    fall.path[i].at.z() = 1 - kGravity * time * time / 2;
  }
  fall.velocity.resize(1);
  fall.spin.resize(1);
  test::differentiate(fall);
  std::vector<Toss> all{fall};
  correct_velocities(all);
  EXPECT_NEAR(all[0].velocity[9].z(), -kGravity * 9 / kRate, 1e-9);
}

}  // namespace
}  // namespace kaz::contact
