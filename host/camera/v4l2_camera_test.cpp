// What can be shown of real cameras without one; tests/v4l2 has the kernel's own drivers.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/v4l2_camera.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

vision::StereoCalibration calibration() {
  vision::StereoCalibration made;
  made.width = 64;
  made.height = 48;
  made.left.lens = made.right.lens = {64, 64, 31.5, 23.5, {}};
  made.rectified = {64, 48, 64, 64, 31.5, 23.5, 0.06};
  return made;
}

TEST(V4l2Camera, SourceOnTheCommandLine) {
  const auto two = parse_v4l2_source("v4l2:/dev/video0,/dev/video2");
  ASSERT_TRUE(two);
  EXPECT_EQ(two->left, "/dev/video0");
  EXPECT_EQ(two->right, "/dev/video2");
  EXPECT_EQ(two->rate_hz, 30);
  EXPECT_FALSE(two->format);
  const auto all = parse_v4l2_source("v4l2:a,b,format=mjpeg,fps=14.5");
  ASSERT_TRUE(all);
  EXPECT_EQ(all->rate_hz, 14.5);
  EXPECT_EQ(all->format, PixelFormat::mjpeg);
  const std::pair<const char*, const char*> wrong[] = {
      {"v4l2:", "two devices"},
      {"v4l2:a", "two devices"},
      {"v4l2:a,", "two devices"},
      {"v4l2:,b", "two devices"},
      {"v4l2:a,a", "the same device"},
      {"v4l2:a,b,fps=", "the rate must be 1 to 1000"},
      {"v4l2:a,b,fps=0", "the rate must be 1 to 1000"},
      {"v4l2:a,b,fps=nan", "the rate must be 1 to 1000"},
      {"v4l2:a,b,fps=30x", "the rate must be 1 to 1000"},
      {"v4l2:a,b,format=h264", "not a supported format"},
      {"v4l2:a,b,size=2", "is unknown"},
      {"v4l2:a,b,", "is unknown"}};
  for (const auto& [text, why] : wrong) {
    const auto parsed = parse_v4l2_source(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().fault, Fault::usage);
    EXPECT_NE(parsed.error().message.find(why), std::string::npos) << parsed.error().message;
    EXPECT_NE(parsed.error().message.find("as in v4l2:/dev/video0"), std::string::npos);
  }
}

TEST(V4l2Camera, ErrorsSayWhatWhereAndWhatToDo) {
  const std::pair<int, const char*> cases[] = {
      {ENOENT, "there is no such device; plug the camera in"},
      {EACCES, "permission denied; become a member of the group video"},
      {EBUSY, "another program uses the camera; end that program (`fuser /dev/video7`"},
      {ENODEV, "the camera was unplugged; plug it in"},
      {ENOSPC, "not have enough bandwidth; plug the cameras into different ports"},
      {EIO, "starting its stream failed (Input/output error); unplug it"}};
  for (const auto& [number, text] : cases) {
    const Error error = v4l2_error("/dev/video7", "starting its stream", number);
    EXPECT_EQ(error.fault, Fault::environment);
    EXPECT_TRUE(error.message.starts_with("no camera at /dev/video7: ")) << error.message;
    EXPECT_NE(error.message.find(text), std::string::npos) << error.message;
    EXPECT_EQ(error.message.find('\n'), std::string::npos);
  }
}

TEST(V4l2Camera, FilesThatAreNoCameraAreReported) {
  const auto file = std::filesystem::temp_directory_path() / "kaz_v4l2_camera_test";
  std::ofstream(file) << "no camera";
  const std::pair<std::string, const char*> cases[] = {
      {"/dev/kaz-has-no-such-camera", "there is no such device"},
      {file.string(), "this file is not a V4L2 video device"},
      {"/dev/null", "this file is not a V4L2 video device"}};
  for (const auto& [path, why] : cases) {
    const auto camera = V4l2Camera::open({path, "/dev/zero", 30, {}}, calibration());
    ASSERT_FALSE(camera);
    EXPECT_NE(camera.error().message.find(path + ": " + why), std::string::npos)
        << camera.error().message;
  }
  std::filesystem::remove(file);
}

TEST(V4l2Camera, TimeIsTheMiddleOfTheExposure) {
  EXPECT_EQ(middle_of_exposure(Time(100ms), Stamp::start_of_exposure, Time(10ms)), Time(105ms));
  EXPECT_EQ(middle_of_exposure(Time(100ms), Stamp::end_of_frame, Time(10ms)), Time(95ms));
  EXPECT_EQ(middle_of_exposure(Time(100ms), Stamp::end_of_frame, Time{}), Time(100ms));
}

}  // namespace
}  // namespace kaz::host
