// Pairs of pictures in a folder: by number, complete, of one size.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision/picture_pairs.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "shared/base/files.hpp"
#include "tools/drawing/figure.h"
#include "tools/vision/calibrate_stereo.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

class PicturePairs : public testing::Test {
 protected:
  PicturePairs() : folder_(make_temporary_folder("kaz-pairs-").value()) {}
  ~PicturePairs() override {
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  std::string at(const std::string& name) const { return folder_ + "/" + name; }
  // Only names count here; the files are no pictures.
  void touch(std::initializer_list<const char*> names) const {
    for (const char* name : names) std::ofstream(at(name)) << "x";
  }
  Result<std::vector<PicturePair>> found() const {
    return find_pairs({at("left*")}, {at("right*")});
  }
  // "left1-right1 left2-right2", or the error's message.
  std::string names() const {
    const auto pairs = found();
    if (!pairs) return pairs.error().message;
    std::string text;
    for (const PicturePair& pair : *pairs)
      text += (text.empty() ? "" : " ") + fs::path(pair.left).filename().string() + "-" +
              fs::path(pair.right).filename().string();
    return text;
  }
  // A usage error whose message contains all of `parts`.
  void expect_refused(std::initializer_list<std::string> parts) const {
    const auto pairs = found();
    ASSERT_FALSE(pairs);
    EXPECT_EQ(pairs.error().fault, Fault::usage);
    for (const std::string& part : parts)
      EXPECT_NE(pairs.error().message.find(part), std::string::npos) << pairs.error().message;
  }
  std::string folder_;
};

TEST_F(PicturePairs, AreInTheOrderOfTheirNumbers) {
  touch({"left_10.png", "left_9.png", "left_100.png", "right_100.png", "right_9.png",
         "right_10.png"});
  EXPECT_EQ(names(), "left_9.png-right_9.png left_10.png-right_10.png left_100.png-right_100.png");
}

TEST_F(PicturePairs, MatchByTheLastNumberWithoutLeadingZeros) {
  touch({"left2_007.png", "right1_7.jpg"});
  EXPECT_EQ(names(), "left2_007.png-right1_7.jpg");
}

TEST_F(PicturePairs, OneOfEachNeedsNoNumber) {
  touch({"left.png", "right.png"});
  EXPECT_EQ(names(), "left.png-right.png");
}

TEST_F(PicturePairs, AFileNamedTwiceCountsOnce) {
  touch({"left_1.png", "right_1.png"});
  const auto pairs = find_pairs({at("left_1.png"), at("left*")}, {at("right*")});
  ASSERT_TRUE(pairs) << pairs.error().message;
  EXPECT_EQ(pairs->size(), 1u);
}

TEST_F(PicturePairs, NameThePictureWithoutAPartner) {
  touch({"left_1.png", "left_2.png", "right_1.png"});
  expect_refused({"left_2.png' has no partner", "among the right", "2 left, 1 right"});
}

TEST_F(PicturePairs, NameThePictureWithoutAPartnerOnTheOtherSide) {
  touch({"left_1.png", "right_1.png", "right_3.png"});
  expect_refused({"right_3.png' has no partner", "among the left", "1 left, 2 right"});
}

TEST_F(PicturePairs, RefuseTwoPicturesOfOneNumber) {
  touch({"left_1.png", "left_01.png", "right_1.png"});
  expect_refused({"left_1.png", "left_01.png", "--left", "the same number"});
}

TEST_F(PicturePairs, RefuseTwoPicturesWithoutNumber) {
  touch({"left_raw.png", "left_ideal.png", "right_raw.png", "right_ideal.png"});
  expect_refused({"left_ideal.png", "left_raw.png", "have no number in their names"});
}

TEST_F(PicturePairs, NameThePatternThatNoFileMatches) {
  touch({"left_1.png"});
  expect_refused({at("right*"), "--right"});
}

// Both eyes of a rig, and all pictures of one eye, have as many pixels.
TEST_F(PicturePairs, OfUnequalSizesAreNoBasisForACalibration) {
  const auto draw = [&](const std::string& name, int width, int height) {
    const std::size_t bytes =
        3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    const vision::Image grey{width, height, std::vector<std::uint8_t>(bytes, 128)};
    const auto written = figure::write_png(at(name), grey);
    ASSERT_TRUE(written) << written.error().message;
  };
  draw("left_1.png", 160, 120);
  draw("right_1.png", 160, 100);
  StereoCalibrationOptions options;
  options.left = {at("left*")};
  options.right = {at("right*")};
  options.board = "9x6";
  options.square_m = 0.02;
  options.out = at("eyes.yml");
  options.json = true;
  const auto done = calibrate_stereo(options);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().fault, Fault::usage);
  for (const std::string part : {"right_1.png", "160 x 100", "160 x 120"})
    EXPECT_NE(done.error().message.find(part), std::string::npos) << done.error().message;
  EXPECT_FALSE(fs::exists(at("eyes.yml")));
}

}  // namespace
}  // namespace kaz::tools
