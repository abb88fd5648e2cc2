// `kaz sim --write-calibration`: the file as OpenCV reads it, against the cameras of the robot.
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "sim/runtime/eyes/eyes.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

struct Written {
  Finished finished;
  cv::FileStorage file;
  cv::Mat matrix(const char* name) const {
    cv::Mat m;
    file[name] >> m;
    EXPECT_FALSE(m.empty()) << name;
    return m;
  }
};

Written written(const std::string& eyes, const std::string& width, const std::string& path) {
  Written w;
  w.finished = run(kaz({"sim", "--eyes", eyes, "--eye-width", width, "--mcu", "native",
                        "--write-calibration", path}));
  EXPECT_EQ(w.finished.exit_code, 0) << w.finished.err;
  w.file.open(path, cv::FileStorage::READ);
  EXPECT_TRUE(w.file.isOpened());
  return w;
}

TEST(CalibrationFile, OfRealEyesHoldsTheirLensesAndHowTheyAreTurned) {
  const TemporaryFolder folder;
  const Written w = written("real", "640", folder / "eyes.yml");
  auto camera = sim::CameraFile::load("shared/robot/kaz/camera.json");
  ASSERT_TRUE(camera) << camera.error().message;
  camera->ideal = false;
  camera->eye.width = 640;
  camera->eye.height = 480;
  const vision::StereoCalibration expected = camera->calibration();
  EXPECT_EQ(static_cast<int>(w.file["image_width"]), 640);
  EXPECT_EQ(static_cast<int>(w.file["image_height"]), 480);
  const struct {
    const char *matrix, *distortion, *turn;
    const vision::StereoCalibration::Eye& eye;
  } eyes[] = {{"camera_matrix_left", "distortion_coefficients_left", "R1", expected.left},
              {"camera_matrix_right", "distortion_coefficients_right", "R2", expected.right}};
  for (const auto& [matrix, distortion, turn, eye] : eyes) {
    // 17 digits are written: the same numbers come back.
    const cv::Mat k = w.matrix(matrix), d = w.matrix(distortion), r = w.matrix(turn);
    EXPECT_EQ(k.at<double>(0, 0), eye.lens.fx) << matrix;
    EXPECT_EQ(k.at<double>(1, 1), eye.lens.fy) << matrix;
    EXPECT_EQ(k.at<double>(0, 2), eye.lens.cx) << matrix;
    EXPECT_EQ(k.at<double>(1, 2), eye.lens.cy) << matrix;
    ASSERT_EQ(d.total(), eye.lens.distortion.size());
    for (int i = 0; i < 5; ++i)
      EXPECT_EQ(d.at<double>(i), eye.lens.distortion[static_cast<std::size_t>(i)]) << distortion;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        EXPECT_EQ(r.at<double>(i, j), eye.rectified_from_camera(i, j)) << turn;
    }
  }
  // The URDF says where the eyes are: 40 mm apart.
  EXPECT_NEAR(cv::norm(w.matrix("T")), 0.040, 1e-12);
  EXPECT_NEAR(w.matrix("P2").at<double>(0, 3), -expected.rectified.fx * 0.040, 1e-9);
}

TEST(CalibrationFile, OfIdealEyesIsThatOfTwoParallelPinholes) {
  const TemporaryFolder folder;
  const Written w = written("ideal", "320", folder / "eyes.yml");
  EXPECT_EQ(cv::norm(w.matrix("distortion_coefficients_left")), 0);
  EXPECT_EQ(cv::norm(w.matrix("distortion_coefficients_right")), 0);
  EXPECT_EQ(cv::norm(w.matrix("R"), cv::Mat::eye(3, 3, CV_64F)), 0);
  EXPECT_EQ(cv::norm(w.matrix("camera_matrix_left"), w.matrix("camera_matrix_right")), 0);
}

TEST(CalibrationFile, IsNotWrittenWhereThereIsNoFolder) {
  const TemporaryFolder folder;
  const std::string path = folder / "none/eyes.yml";
  const Finished finished =
      run(kaz({"sim", "--mcu", "native", "--eyes", "real", "--write-calibration", path}));
  EXPECT_NE(finished.exit_code, 0);
  EXPECT_NE(finished.err.find(path), std::string::npos) << finished.err;
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace kaz::test
