// Calibrations of other programs: camera_info files of ROS, and OpenCV's XML.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/camera_info.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>

#include <opencv2/core.hpp>

#include "shared/base/files.hpp"
#include "vision/calibration/calibration_file.h"

namespace kaz::vision {
namespace {

// As the node cameracalibrator of ROS writes the file of a left camera.
constexpr const char* kLeftOfRos = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo/left
camera_matrix:
  rows: 3
  cols: 3
  data: [437.39351,   0.     , 320.70246,
           0.     , 437.65612, 240.70195,
           0.     ,   0.     ,   1.     ]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.351222, 0.123456, 0.000321, -0.000412, 0.000000]
rectification_matrix:
  rows: 3
  cols: 3
  data: [ 1.0, 0.0, 0.0,
          0.0, 1.0, 0.0,
          0.0, 0.0, 1.0]
projection_matrix:
  rows: 3
  cols: 4
  data: [400.5,   0. , 318.25,   0. ,
           0. , 400.5, 241.75,   0. ,
           0. ,   0. ,   1. ,   0. ]
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string right_of_ros() {
  return replaced(replaced(kLeftOfRos, "stereo/left", "stereo/right"), "318.25,   0. ,",
                  "318.25, -40.05,");
}

Result<StereoCalibration> read_pair(const std::string& left, const std::string& right) {
  return parse_camera_info({left, right}, {"l.yaml", "r.yaml"});
}

std::string error_of(const std::string& left, const std::string& right) {
  const auto read = read_pair(left, right);
  return read ? std::string("was read") : read.error().message;
}

StereoCalibration tilted_eyes() {
  StereoCalibration c;
  c.width = 320;
  c.height = 240;
  c.left.lens = {209.3, 208.1, 161.2, 118.4, {-0.18, 0.03, 0.0006, -0.0004, 1e-5}};
  c.right.lens = {210.7, 209.9, 158.9, 121.0, {-0.17, 0.02, -0.0003, 0.0005, 0.002}};
  const Eigen::Matrix3d r =
      Eigen::AngleAxisd(0.01, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_TRUE(rectify_pair(c, r, {-0.0401, 0.0003, -0.0005}));
  return c;
}

TEST(CameraInfo, ReadsTheFilesOfRos) {
  const auto read = read_pair(kLeftOfRos, right_of_ros());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->width, 640);
  EXPECT_EQ(read->height, 480);
  EXPECT_EQ(read->left.lens.fx, 437.39351);
  EXPECT_EQ(read->left.lens.fy, 437.65612);
  EXPECT_EQ(read->left.lens.cx, 320.70246);
  EXPECT_EQ(read->left.lens.cy, 240.70195);
  EXPECT_EQ(read->right.lens.distortion,
            (std::array{-0.351222, 0.123456, 0.000321, -0.000412, 0.0}));
  EXPECT_EQ(read->rectified.fx, 400.5);
  EXPECT_EQ(read->rectified.cx, 318.25);
  EXPECT_EQ(read->rectified.cy, 241.75);
  EXPECT_NEAR(read->rectified.baseline_m, 0.1, 1e-15);
}

TEST(CameraInfo, ComesBackExactlyAsItWasWritten) {
  const StereoCalibration c = tilted_eyes();
  const CameraInfoPair text = camera_info_text(c);
  const auto read = read_pair(text.left, text.right);
  ASSERT_TRUE(read) << read.error().message;
  for (const auto& [a, b] : {std::pair(c.left, read->left), std::pair(c.right, read->right)}) {
    EXPECT_EQ(a.lens.fx, b.lens.fx);
    EXPECT_EQ(a.lens.cy, b.lens.cy);
    EXPECT_EQ(a.lens.distortion, b.lens.distortion);
    EXPECT_EQ(a.rectified_from_camera, b.rectified_from_camera);
  }
  EXPECT_EQ(c.rectified.fx, read->rectified.fx);
  EXPECT_EQ(c.rectified.cx, read->rectified.cx);
  EXPECT_NEAR(c.rectified.baseline_m, read->rectified.baseline_m, 1e-17);
  EXPECT_EQ(camera_info_text(*read).left, text.left);
  EXPECT_NE(text.left.find("1.0e-05"), std::string::npos) << "YAML 1.1 needs the point";
}

TEST(CameraInfo, RefusesOtherLensesByTheNameOfTheirModel) {
  const std::string fisheye = replaced(kLeftOfRos, "plumb_bob", "equidistant");
  EXPECT_NE(error_of(fisheye, right_of_ros()).find("l.yaml: distortion_model is equidistant"),
            std::string::npos);
  const auto rational = [](const std::string& k4) {
    return replaced(
        replaced(replaced(kLeftOfRos, "plumb_bob", "rational_polynomial"), "cols: 5", "cols: 8"),
        "0.000000]", "0.000000, " + k4 + ", 0, 0]");
  };
  EXPECT_EQ(error_of(rational("0"), right_of_ros()), "was read");
  EXPECT_NE(error_of(rational("0.1"), right_of_ros()).find("rational"), std::string::npos);
}

TEST(CameraInfo, NamesTheFileAndTheKeyThatIsWrong) {
  const std::string left = kLeftOfRos, right = right_of_ros();
  for (const auto& [from, to, what] :
       {std::tuple("image_width: 640", "image_width: 320", "must have the same size"),
        std::tuple("camera_matrix:", "camera_matrices:", "camera_matrix is missing"),
        std::tuple("cols: 3", "cols: 4", "camera_matrix has rows: 3 and cols: 4, but 9 numbers"),
        std::tuple("-40.05", "40.05", "projection_matrix puts the right eye to the left"),
        std::tuple("400.5", "401.5", "projection_matrix has another focal length"),
        std::tuple("241.75,   0. ", "241.75, -40.0", "puts one eye above the other"),
        std::tuple("-0.351222", "x", "distortion_coefficients has an element")}) {
    const std::string error = error_of(left, replaced(right, from, to));
    EXPECT_EQ(error.find("r.yaml: "), 0u) << error;
    EXPECT_NE(error.find(what), std::string::npos) << error;
  }
  EXPECT_NE(error_of(right, left).find("exchanged"), std::string::npos);
  const auto one = parse_calibration(left, "l.yaml");
  ASSERT_FALSE(one);
  EXPECT_NE(one.error().message.find("LEFT.yaml,RIGHT.yaml"), std::string::npos)
      << one.error().message;
}

TEST(CameraInfo, TwoPathsWithACommaAreAPair) {
  const std::string folder = make_temporary_folder("kaz-camera-info").value();
  const std::string left = folder + "/l.yaml", right = folder + "/r.yaml";
  ASSERT_TRUE(write_whole_file(left, kLeftOfRos));
  ASSERT_TRUE(write_whole_file(right, right_of_ros()));
  const auto read = read_calibration(left + "," + right);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->rectified.fx, 400.5);
  EXPECT_FALSE(read_calibration(left + "," + folder + "/none.yaml"));
  EXPECT_EQ(*calibration_format("l.yaml,r.yml"), CalibrationFormat::camera_info);
  EXPECT_FALSE(calibration_format("l.yaml,r.json"));
  std::filesystem::remove_all(folder);
}

TEST(CalibrationXml, ReadsWhatOpenCvWrites) {
  const StereoCalibration c = tilted_eyes();
  const std::string xml =
      calibration_text(c, CalibrationFormat::xml, {{"rms_px", 0.25}}, "12:30 today");
  EXPECT_NE(xml.find("<opencv_storage>"), std::string::npos);
  const auto read = parse_calibration(xml, "eyes.xml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->left.lens.distortion, c.left.lens.distortion);
  EXPECT_EQ(read->rectified.fx, c.rectified.fx);
  EXPECT_EQ(
      calibration_text(*read, CalibrationFormat::yaml),
      calibration_text(parse_calibration(calibration_text(c, CalibrationFormat::yaml), "y").value(),
                       CalibrationFormat::yaml));
}

// OpenCV's stereo sample: short names, no rectification, other types of numbers.
TEST(CalibrationXml, ReadsTheShortNamesOfOpenCvInEveryFormat) {
  for (const int format :
       {cv::FileStorage::FORMAT_YAML, cv::FileStorage::FORMAT_XML, cv::FileStorage::FORMAT_JSON}) {
    cv::FileStorage file("", cv::FileStorage::WRITE | cv::FileStorage::MEMORY | format);
    const cv::Mat k = (cv::Mat_<double>(3, 3) << 400, 0, 320, 0, 400, 240, 0, 0, 1);
    file << "image_width" << 640 << "image_height" << 480;
    file << "M1" << k << "D1" << cv::Mat::zeros(1, 5, CV_32F) << "M2" << k << "D2"
         << cv::Mat::zeros(1, 14, CV_64F);
    file << "R" << cv::Mat::eye(3, 3, CV_64F) << "T" << (cv::Mat_<double>(3, 1) << -0.06, 0, 0);
    const std::string text = file.releaseAndGetString();
    const auto read = parse_calibration(text, "stereo");
    ASSERT_TRUE(read) << read.error().message << text;
    EXPECT_NEAR(read->rectified.baseline_m, 0.06, 1e-9);
    EXPECT_EQ(read->left.lens.fx, 400);
  }
}

TEST(CalibrationXml, NamesTheLineOfDamage) {
  const std::string xml = calibration_text(tilted_eyes(), CalibrationFormat::xml);
  const auto cut = parse_calibration(xml.substr(0, xml.size() / 2), "eyes.xml");
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().message.find("eyes.xml:"), 0u) << cut.error().message;
  EXPECT_NE(cut.error().message.find("not well-formed"), std::string::npos) << cut.error().message;
  const auto other = parse_calibration("<robot/>", "eyes.xml");
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("eyes.xml:1: "), std::string::npos);
  EXPECT_NE(other.error().message.find("opencv_storage"), std::string::npos);
}

TEST(CalibrationXml, AFisheyeModelIsRefused) {
  const std::string yaml = calibration_text(tilted_eyes(), CalibrationFormat::yaml);
  const auto fisheye = parse_calibration(yaml + "fisheye_model: 1\n", "eyes.yml");
  ASSERT_FALSE(fisheye);
  EXPECT_NE(fisheye.error().message.find("fisheye"), std::string::npos);
  EXPECT_TRUE(parse_calibration(yaml + "fisheye_model: 0\n", "eyes.yml"));
}

}  // namespace
}  // namespace kaz::vision
