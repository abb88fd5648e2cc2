// Calibration files: what is written comes back, and each fault is named with file and key.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/calibration_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shared/base/random.hpp"
#include "vision/calibration/rectify.h"

namespace kaz::vision {
namespace {

Eigen::Matrix3d turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

// Eyes a little askew, rectified as the program does it.
StereoCalibration askew() {
  StereoCalibration c;
  c.width = 320;
  c.height = 240;
  c.left.lens = {209.3, 208.1, 161.2, 118.4, {-0.18, 0.03, 0.0006, -0.0004, 0.001}};
  c.right.lens = {210.7, 209.9, 158.9, 121.0, {-0.17, 0.02, -0.0003, 0.0005, 0.002}};
  EXPECT_TRUE(rectify_pair(c, turn(0.01, {1, 2, 3}), {-0.0401, 0.0003, -0.0005}));
  return c;
}

void expect_same(const StereoCalibration& a, const StereoCalibration& b, double tolerance) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  for (const auto& [one, other] : {std::pair(a.left, b.left), std::pair(a.right, b.right)}) {
    EXPECT_NEAR(one.lens.fx, other.lens.fx, tolerance);
    EXPECT_NEAR(one.lens.fy, other.lens.fy, tolerance);
    EXPECT_NEAR(one.lens.cx, other.lens.cx, tolerance);
    EXPECT_NEAR(one.lens.cy, other.lens.cy, tolerance);
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_NEAR(one.lens.distortion[i], other.lens.distortion[i], tolerance);
    EXPECT_LE((one.rectified_from_camera - other.rectified_from_camera).norm(), tolerance);
  }
  EXPECT_NEAR(a.rectified.fx, b.rectified.fx, tolerance);
  EXPECT_NEAR(a.rectified.fy, b.rectified.fy, tolerance);
  EXPECT_NEAR(a.rectified.cx, b.rectified.cx, tolerance);
  EXPECT_NEAR(a.rectified.cy, b.rectified.cy, tolerance);
  EXPECT_NEAR(a.rectified.baseline_m, b.rectified.baseline_m, tolerance);
}

std::string without(std::string yaml, const std::string& key) {
  const auto begin = yaml.find("\n" + key + ": ") + 1;
  auto end = yaml.find('\n', begin);
  while (end + 1 < yaml.size() && yaml[end + 1] == ' ') end = yaml.find('\n', end + 1);
  return yaml.erase(begin, end + 1 - begin);
}

// `columns`: of the matrix of one row that it then is; empty: the shape stays.
std::string with_data(const std::string& yaml, const std::string& key, const std::string& data,
                      const std::string& columns = "") {
  std::string text = yaml;
  const auto at = text.find("\n" + key + ": ");
  const auto begin = text.find('[', at);
  text.replace(begin, text.find(']', begin) + 1 - begin, "[ " + data + " ]");
  if (!columns.empty()) text.replace(text.find("cols: ", at), 7, "cols: " + columns);
  return text;
}

std::string message(const std::string& text) {
  const auto read = parse_calibration(text, "eyes.yml");
  return read ? std::string("was read") : read.error().message;
}

TEST(CalibrationFile, ComesBackAsItWasWritten) {
  const StereoCalibration c = askew();
  for (const auto format : {CalibrationFormat::yaml, CalibrationFormat::json}) {
    const std::string text =
        calibration_text(c, format, {{"rms_px", 0.25}}, "2026-11-24T00:35:00Z");
    EXPECT_NE(text.find("2026-11-24T00:35:00Z\""), std::string::npos) << text;
    const auto read = parse_calibration(text, "a");
    ASSERT_TRUE(read) << read.error().message;
    // 17 digits; the baseline is a quotient.
    expect_same(*read, c, 1e-12);
  }
}

TEST(CalibrationFile, ReadsWhatTheVirtualRobotWrites) {
  const StereoCalibration c = askew();
  const auto read = parse_calibration(c.yaml(), "a");
  ASSERT_TRUE(read) << read.error().message;
  expect_same(*read, c, 1e-12);
}

TEST(CalibrationFile, RectifiesWhatHoldsNoRectification) {
  const StereoCalibration c = askew();
  std::string text = calibration_text(c, CalibrationFormat::yaml);
  for (const char* key : {"R1", "R2", "P1", "P2", "Q"}) text = without(text, key);
  const auto read = parse_calibration(text, "a");
  ASSERT_TRUE(read) << read.error().message;
  // R and T were put together from R1, R2 and the baseline, and taken apart again.
  expect_same(*read, c, 1e-6);
}

TEST(CalibrationFile, ReadsTheNamesOfOpenCvsSample) {
  const StereoCalibration c = askew();
  std::string text = calibration_text(c, CalibrationFormat::yaml);
  for (const auto& [from, to] :
       {std::pair("camera_matrix_left", "M1"), std::pair("camera_matrix_right", "M2"),
        std::pair("distortion_coefficients_left", "D1"),
        std::pair("distortion_coefficients_right", "D2")})
    text.replace(text.find(from), std::string(from).size(), to);
  const auto read = parse_calibration(text, "a");
  ASSERT_TRUE(read) << read.error().message;
  expect_same(*read, c, 1e-12);
}

TEST(CalibrationFile, NamesFileAndKeyOfWhatIsMissing) {
  const std::string whole = calibration_text(askew(), CalibrationFormat::yaml);
  for (const std::string key :
       {"image_width", "image_height", "camera_matrix_left", "camera_matrix_right",
        "distortion_coefficients_left", "distortion_coefficients_right", "R", "T", "R1", "R2", "P1",
        "P2"}) {
    EXPECT_EQ(message(without(whole, key)), "eyes.yml: " + key + " is missing");
  }
}

TEST(CalibrationFile, NamesWhatIsWrong) {
  const std::string whole = calibration_text(askew(), CalibrationFormat::yaml);
  const auto expect = [&](const std::string& key, const std::string& data, const std::string& why,
                          const std::string& columns = "") {
    const std::string said = message(with_data(whole, key, data, columns));
    EXPECT_EQ(said.rfind("eyes.yml: ", 0), 0u) << said;
    EXPECT_NE(said.find(key), std::string::npos) << said;
    EXPECT_NE(said.find(why), std::string::npos) << said;
  };
  expect("camera_matrix_left", "1., 0., 0.", "3 numbers");
  expect("camera_matrix_left", "0., 0., 5., 0., 9., 5., 0., 0., 1.", "not above 0");
  expect("camera_matrix_left", "9., 1., 5., 0., 9., 5., 0., 0., 1.", "the form [fx");
  expect("camera_matrix_right", "9., 0., 1e999, 0., 9., 5., 0., 0., 1.", "exceeds 1e12");
  expect("camera_matrix_right", ".Nan, 0., 5., 0., 9., 5., 0., 0., 1.", "not finite");
  expect("camera_matrix_right", "9., 0., .Inf, 0., 9., 5., 0., 0., 1.", "not finite");
  expect("camera_matrix_right", "a, 0., 5., 0., 9., 5., 0., 0., 1.", "not a number");
  expect("distortion_coefficients_left", "0., 0., 0., 0., 0., .1, 0., 0.", "five coefficients",
         "8");
  expect("R1", "1., 0., 0., 0., 1., 0., 0., 0., -1.", "not a rotation");
  expect("P2", "9., 0., 5., 0., 0., 9., 5., 0., 0., 0., 1., 0.", "another focal length");
  expect("T", "-0.05, 0., 0.", "do not match");
  for (const std::string shape : {"cols: -3", "cols: 0", "cols: 1e9", "cols: 2.5", "cols: x"}) {
    std::string wrong = whole;
    wrong.replace(wrong.find("cols: 3"), 7, shape);
    EXPECT_NE(message(wrong).find(" has " + shape + "; a matrix has 1 to 14"), std::string::npos)
        << message(wrong);
  }
  std::string rows = whole;
  rows.replace(rows.find("rows: 3"), 7, "rows: -3");
  EXPECT_NE(message(rows).find("camera_matrix_left has rows: -3"), std::string::npos)
      << message(rows);
  std::string shape = whole;
  shape.replace(shape.find("rows: 3"), 7, "rows: 2");
  EXPECT_NE(message(shape).find("has rows: 2 and cols: 3, but 9 numbers"), std::string::npos)
      << message(shape);
  std::string odd = whole;
  odd.replace(odd.find("image_width: 320"), 16, "image_width: -3 ");
  EXPECT_NE(message(odd).find("image_width is -3"), std::string::npos) << message(odd);
  EXPECT_NE(message("%YAML:1.0\n---\n").find("image_width is missing"), std::string::npos);
  EXPECT_NE(message("").find("empty"), std::string::npos);
  EXPECT_NE(message("hello").find("eyes.yml: "), std::string::npos);
  EXPECT_NE(message(std::string(30000, '[')).find("eyes.yml: "), std::string::npos);
  EXPECT_NE(message(whole + "R: 3\n").find("has R twice"), std::string::npos);
  for (const std::string more : {"data: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ]", "rows: 3", "cols: 3"}) {
    std::string twice = whole;
    twice.insert(twice.find("rows:", twice.find("\nR: ")), more + "\n   ");
    const std::string keyword = more.substr(0, more.find(':'));
    EXPECT_NE(message(twice).find("eyes.yml: R has " + keyword + " twice"), std::string::npos)
        << message(twice);
  }
  EXPECT_NE(message("%YAML:1.0\n---\nimage_width: [ 320 ]\n").find("image_width is not a number"),
            std::string::npos);
  EXPECT_NE(message(std::string(100000, 'x')).find("64 KB"), std::string::npos);
  EXPECT_FALSE(read_calibration("/nowhere/eyes.yml"));
  EXPECT_FALSE(read_calibration("/"));
}

TEST(CalibrationFile, EightCoefficientsOfWhichThreeAreZeroAreFive) {
  const std::string text =
      with_data(calibration_text(askew(), CalibrationFormat::yaml), "distortion_coefficients_left",
                "-0.18, 0.03, 0.0006, -0.0004, 0.001, 0., 0., 0.", "8");
  const auto read = parse_calibration(text, "a");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->left.lens.distortion[4], 0.001);
}

TEST(CalibrationFile, EyesExchangedOrAboveEachOtherAreRefused) {
  StereoCalibration c = askew();
  const Eigen::Matrix3d straight = Eigen::Matrix3d::Identity();
  const auto exchanged = rectify_pair(c, straight, {0.04, 0, 0});
  ASSERT_FALSE(exchanged);
  EXPECT_NE(exchanged.error().message.find("exchanged"), std::string::npos);
  const auto above = rectify_pair(c, straight, {-0.01, 0.04, 0});
  ASSERT_FALSE(above);
  EXPECT_NE(above.error().message.find("above"), std::string::npos);
  EXPECT_FALSE(rectify_pair(c, straight, {0, 0, 0}));
}

TEST(CalibrationFile, FragmentsAndDamagedBytesNeverDoHarm) {
  const StereoCalibration c = askew();
  Random random(11);
  for (const auto format : {CalibrationFormat::yaml, CalibrationFormat::json}) {
    const std::string whole = calibration_text(c, format);
    // Up to the end of T too little is there; from R1 on a rectification has begun and breaks off.
    const std::size_t t_ends =
        whole.find(']', whole.find("\"T\"") + 1 ? whole.find("\"T\"") : whole.find("\nT:"));
    const std::size_t r1_begins = whole.find("R1"), p2_ends = whole.find(']', whole.find("P2"));
    ASSERT_LT(t_ends, r1_begins);
    for (std::size_t length = 0; length <= p2_ends; ++length) {
      if (length > t_ends && length < r1_begins + 4) continue;
      EXPECT_FALSE(parse_calibration(whole.substr(0, length), "a")) << length;
    }
    for (int round = 0; round < 10000; ++round) {
      std::string text = whole;
      for (int i = 0; i < 3; ++i)
        text[random.below(static_cast<std::uint32_t>(text.size()))] =
            static_cast<char>(random.below(256));
      const auto read = parse_calibration(text, "a");
      if (read) {
        EXPECT_GT(read->rectified.baseline_m, 0);
      }
    }
  }
}

TEST(CalibrationFile, TheFormatIsInTheName) {
  EXPECT_EQ(*calibration_format("a/b.yml"), CalibrationFormat::yaml);
  EXPECT_EQ(*calibration_format("b.json"), CalibrationFormat::json);
  EXPECT_FALSE(calibration_format("b.txt"));
}

// From the file to pictures: a point of both eyes comes to lie on one row.
TEST(CalibrationFile, WhatWasReadRectifies) {
  const auto c = parse_calibration(calibration_text(askew(), CalibrationFormat::json), "a");
  ASSERT_TRUE(c);
  const Rectifier rectifier(*c);
  StereoImages raw{{c->width, c->height, {}}, {c->width, c->height, {}}}, rectified;
  for (Image* image : {&raw.left, &raw.right})
    image->rgb.assign(static_cast<std::size_t>(c->width * c->height * 3), 200);
  rectifier.rectify(raw, rectified);
  // alpha 0: no black edges in either eye, but for the taps at the very border.
  for (const Image* image : {&rectified.left, &rectified.right}) {
    ASSERT_EQ(image->rgb.size(), raw.left.rgb.size());
    const auto dark = std::count(image->rgb.begin(), image->rgb.end(), 0);
    EXPECT_LE(dark, 3 * 2 * (c->width + c->height));
  }
}

}  // namespace
}  // namespace kaz::vision
