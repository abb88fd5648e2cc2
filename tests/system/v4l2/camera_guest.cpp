// The V4L2 camera on two virtual cameras of the kernel (vivid); runs inside the virtual machine.
// SPDX-License-Identifier: Apache-2.0
//
// /dev/video0 and 1: cameras. 2: pictures in several planes only. 3: takes pictures, gives none.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "host/camera/v4l2_camera.h"
#include "host/link/wall_clock.h"
#include "tests/system/v4l2/vivid.h"

namespace kaz::tests {
namespace {

using namespace std::chrono_literals;
using host::PixelFormat;
using host::V4l2Camera;

const std::string kLeft = "/dev/video0", kRight = "/dev/video1";

// Lenses that bend nothing, side by side: rectified pictures are the cameras'.
vision::StereoCalibration calibration(int width = 320, int height = 180) {
  vision::StereoCalibration made;
  const double f = width, cx = (width - 1) / 2.0, cy = (height - 1) / 2.0;
  made.width = width;
  made.height = height;
  made.left.lens = made.right.lens = {f, f, cx, cy, {}};
  made.rectified = {width, height, f, f, cx, cy, 0.06};
  return made;
}

Time now() {
  return host::WallClock().now();
}

// Polls for at most `patience` until `enough` pairs came or the camera stopped.
struct Watched {
  std::vector<vision::StereoPair> pairs;
  std::string error;
  Time longest_poll{};
};
Watched watch(V4l2Camera& camera, std::size_t enough, Time patience) {
  Watched watched;
  const Time end = now() + patience;
  while (watched.pairs.size() < enough && now() < end) {
    const Time before = now();
    auto pair = camera.poll();
    watched.longest_poll = std::max(watched.longest_poll, now() - before);
    if (!pair) {
      watched.error = pair.error().message;
      break;
    }
    if (*pair) watched.pairs.push_back(std::move(**pair));
    if (!*pair) usleep(2000);
  }
  return watched;
}

std::unique_ptr<V4l2Camera> open(const host::V4l2Source& source,
                                 const host::V4l2Options& options = {}) {
  auto camera = V4l2Camera::open(source, calibration(), options);
  if (!camera) {
    ADD_FAILURE() << camera.error().message;
    return nullptr;
  }
  return std::move(*camera);
}

std::string refusal(const host::V4l2Source& source, int width = 320, int height = 180) {
  const auto camera = V4l2Camera::open(source, calibration(width, height));
  return camera ? "opened" : camera.error().message;
}

std::array<int, 3> middle(const vision::Image& image) {
  const std::size_t at =
      3 * (static_cast<std::size_t>(image.height / 2) * static_cast<std::size_t>(image.width) +
           static_cast<std::size_t>(image.width / 2));
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

void expect_color(const vision::Image& image, std::array<int, 3> color, int tolerance) {
  const auto seen = middle(image);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(seen[i], color[i], tolerance) << "channel " << i << " of the middle";
}

class Cameras : public testing::Test {
 protected:
  void SetUp() override {
    for (const auto& path : {kLeft, kRight}) {
      Vivid device(path);
      device.choose("OSD Text Mode", "None");
      device.choose("Test Pattern", "75% Colorbar");
      device.choose("Timestamp Source", "Start of Exposure");
      device.set("Percentage of Dropped Buffers", 0);
    }
  }
};

TEST_F(Cameras, EachFormatHasTheColoursOfItsSide) {
  Vivid(kLeft).choose("Test Pattern", "100% Red");
  Vivid(kRight).choose("Test Pattern", "100% Blue");
  for (const auto format : {PixelFormat::yuyv, PixelFormat::rgb24, PixelFormat::grey}) {
    SCOPED_TRACE(pixel_format_name(format));
    const auto camera = open({kLeft, kRight, 10, format});
    ASSERT_TRUE(camera);
    const auto watched = watch(*camera, 1, 20s);
    ASSERT_EQ(watched.pairs.size(), 1u) << watched.error;
    const auto images = watched.pairs[0].images.get();
    EXPECT_EQ(images->left.width, 320);
    EXPECT_EQ(images->right.height, 180);
    // The driver cuts Y, U and V off to whole numbers: up to 1.2 + 2 of blue. For grey it does not
    // report which range is meant.
    if (format == PixelFormat::grey) {
      EXPECT_GT(middle(images->left)[0], middle(images->right)[0] + 30);
    } else {
      expect_color(images->left, {255, 0, 0}, 4);
      expect_color(images->right, {0, 0, 255}, 4);
    }
  }
}

TEST_F(Cameras, YuvIsReadAsTheDriverMeansIt) {
  for (const char* encoding : {"ITU-R 601", "Rec. 709"}) {
    for (const char* range : {"Full Range", "Limited Range"}) {
      SCOPED_TRACE(std::string(encoding) + ", " + range);
      for (const auto& path : {kLeft, kRight}) {
        Vivid device(path);
        device.choose("Test Pattern", "100% Green");
        device.choose("Y'CbCr Encoding", encoding);
        device.choose("Quantization", range);
      }
      const auto camera = open({kLeft, kRight, 10, PixelFormat::yuyv});
      ASSERT_TRUE(camera);
      const auto watched = watch(*camera, 1, 20s);
      ASSERT_EQ(watched.pairs.size(), 1u) << watched.error;
      expect_color(watched.pairs[0].images.get()->left, {0, 255, 0}, 4);
    }
  }
  for (const auto& path : {kLeft, kRight}) {
    Vivid device(path);
    device.choose("Y'CbCr Encoding", "Default");
    device.choose("Quantization", "Default");
  }
}

TEST_F(Cameras, PairsAreTimedOnTheHostsClockAndNeverWaitedFor) {
  const auto camera = open({kLeft, kRight, 10, {}});
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->mode(host::EyeSide::left), "320 x 180 yuyv, 10 Hz");
  const Time before = now();
  const auto watched = watch(*camera, 15, 30s);
  ASSERT_EQ(watched.pairs.size(), 15u) << watched.error;
  std::vector<Time> steps;
  for (std::size_t i = 0; i < watched.pairs.size(); ++i) {
    const auto& pair = watched.pairs[i];
    EXPECT_EQ(pair.images.wait_for(0s), std::future_status::ready);
    EXPECT_GT(pair.info.exposure, before - 2s);
    EXPECT_LT(pair.info.exposure, now());
    EXPECT_EQ(pair.info.camera.baseline_m, 0.06);
    if (i > 0) steps.push_back(pair.info.exposure - watched.pairs[i - 1].info.exposure);
  }
  std::ranges::sort(steps);
  EXPECT_GT(steps.front(), Time(0));
  // The driver starts a picture at a tick of its kernel, every 4 ms: one tick at either end. A busy
  // machine delays single pictures, hence the median.
  EXPECT_NEAR(seconds(steps[steps.size() / 2]), 0.1, 0.008);
  EXPECT_EQ(camera->statistics().ahead, 0u);
  const auto statistics = camera->statistics();
  EXPECT_EQ(statistics.tolerance, Time(50ms));  // half of 1/10 s
  EXPECT_LE(statistics.largest_gap, statistics.tolerance);
  EXPECT_EQ(statistics.stamps[0], host::Stamp::start_of_exposure);
  // A wait for the next picture would be 100 ms; 50 ms are the virtual machine's hiccups.
  EXPECT_LT(watched.longest_poll, 50ms);
}

// This driver hands a picture out at the beginning of its period and stamps its end: in the future.
TEST_F(Cameras, NoPictureIsExposedAfterItArrived) {
  for (const auto& path : {kLeft, kRight}) Vivid(path).choose("Timestamp Source", "End of Frame");
  const auto camera = open({kLeft, kRight, 10, {}});
  ASSERT_TRUE(camera);
  const auto watched = watch(*camera, 3, 20s);
  ASSERT_EQ(watched.pairs.size(), 3u) << watched.error;
  EXPECT_LT(watched.pairs.back().info.exposure, now());
  EXPECT_EQ(camera->statistics().stamps[0], host::Stamp::end_of_frame);
  EXPECT_GE(camera->statistics().ahead, 2u);
}

TEST_F(Cameras, PicturesWithoutPartnerAreDroppedAndCounted) {
  Vivid(kRight).set("Percentage of Dropped Buffers", 50);
  const auto camera = open({kLeft, kRight, 25, {}}, {Time{}, 5s});
  ASSERT_TRUE(camera);
  const auto watched = watch(*camera, 10, 30s);
  ASSERT_EQ(watched.pairs.size(), 10u) << watched.error;
  EXPECT_GE(camera->statistics().without_partner, 2u);  // about 10; each is lost with even odds
}

TEST_F(Cameras, ASlowUserGetsTheNewest) {
  const auto camera = open({kLeft, kRight, 25, {}});
  ASSERT_TRUE(camera);
  ASSERT_EQ(watch(*camera, 1, 20s).pairs.size(), 1u);
  sleep(2);
  EXPECT_GT(camera->statistics().not_taken, 0u);
  const auto pair = camera->poll();
  ASSERT_TRUE(pair && *pair);
  EXPECT_GT((*pair)->info.exposure, now() - 1s);  // at most four wait
}

TEST_F(Cameras, DamagedPicturesAreCounted) {
  const auto camera = open({kLeft, kRight, 25, {}});
  ASSERT_TRUE(camera);
  ASSERT_EQ(watch(*camera, 1, 20s).pairs.size(), 1u);
  Vivid(kLeft).set("Inject V4L2_BUF_FLAG_ERROR", 1);
  EXPECT_EQ(watch(*camera, 5, 20s).pairs.size(), 5u);
  EXPECT_EQ(camera->statistics().damaged, 1u);
}

TEST_F(Cameras, AnUnpluggedCameraStopsWithASentence) {
  for (const auto& path : {kLeft, kRight}) {
    {
      const auto camera = open({kLeft, kRight, 25, {}});
      ASSERT_TRUE(camera);
      ASSERT_EQ(watch(*camera, 1, 20s).pairs.size(), 1u);
      Vivid(path).set("Disconnect", 1);
      const Time pulled = now();
      const auto watched = watch(*camera, 1000, 10s);
      EXPECT_EQ(
          watched.error,
          "camera " + path + " stopped: the camera was unplugged; plug it in and start again");
      EXPECT_LT(now() - pulled, 1s);
      EXPECT_FALSE(camera->poll());  // it stays stopped
    }
    EXPECT_TRUE(open({kLeft, kRight, 25, {}}));  // plugged in again
  }
}

TEST_F(Cameras, AFatalErrorOfTheDriverStops) {
  const auto camera = open({kLeft, kRight, 25, {}});
  ASSERT_TRUE(camera);
  ASSERT_EQ(watch(*camera, 1, 20s).pairs.size(), 1u);
  Vivid(kRight).set("Inject Fatal Streaming Error", 1);
  EXPECT_EQ(watch(*camera, 1000, 10s).error,
            "camera /dev/video1 stopped: its driver failed (Input/output error); plug it in and "
            "start again");
}

TEST_F(Cameras, ASilentCameraStopsAfterTheStatedTime) {
  const auto camera = open({kLeft, kRight, 25, {}}, {Time{}, 1s});
  ASSERT_TRUE(camera);
  ASSERT_EQ(watch(*camera, 3, 20s).pairs.size(), 3u);
  Vivid(kRight).set("Percentage of Dropped Buffers", 100);
  const Time silent = now();
  const auto watched = watch(*camera, 1000, 10s);
  EXPECT_EQ(watched.error,
            "camera /dev/video1 stopped: no picture came for 1 s; check its cable and start again");
  // The last picture came up to 40 ms before; late is the virtual machine.
  EXPECT_GT(now() - silent, 900ms);
  EXPECT_LT(now() - silent, 3s);
}

TEST_F(Cameras, PicturesThatAreNeverPairsStopAfterTheStatedTime) {
  const auto camera = open({kLeft, kRight, 25, {}}, {Time(1), 1s});  // of two clocks, a nanosecond
  ASSERT_TRUE(camera);
  EXPECT_EQ(watch(*camera, 1, 10s).error,
            "cameras /dev/video0 and /dev/video1 stopped: pictures come, but for 1 s there was "
            "no valid pair with at most 1e-06 ms between its pictures; try another format or fps");
  EXPECT_GT(camera->statistics().without_partner, 10u);  // of about 50
}

TEST_F(Cameras, ReportsWhyACameraCannotBeOpened) {
  const auto expect_in = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect_in(refusal({kLeft, "/dev/video9", 10, {}}),
            "no camera at /dev/video9: there is no such device; plug the camera in");
  expect_in(refusal({kLeft, "/dev/video2", 10, {}}), "delivers only multi-planar pictures");
  expect_in(refusal({"/dev/video3", kRight, 10, {}}),
            "/dev/video3: this node of vivid delivers no");
  expect_in(refusal({kLeft, kRight, 10, {}}, 333, 222),
            "the calibration is for pictures of 333 x 222, but the camera does not offer this "
            "size; the camera offers 320 x 180, 640 x 360, 640 x 480,");
  expect_in(refusal({kLeft, kRight, 10, PixelFormat::mjpeg}), "; mjpeg was requested");
  {
    Vivid other(kRight);
    other.reserve_buffers();
    expect_in(refusal({kLeft, kRight, 10, {}}),
              "no camera at /dev/video1: another program uses the camera; end that program");
  }
  ASSERT_EQ(seteuid(1000), 0);
  const std::string refused = refusal({kLeft, kRight, 10, {}});
  ASSERT_EQ(seteuid(0), 0);
  expect_in(refused, "no camera at /dev/video0: permission denied; become a member of the group");
  Vivid(kLeft).set("Inject VIDIOC_STREAMON Error", 1);
  expect_in(refusal({kLeft, kRight, 10, {}}), "starting its stream failed (Invalid argument)");
  EXPECT_EQ(refusal({kLeft, kRight, 10, {}}), "opened");
}

TEST_F(Cameras, LargerPictures) {
  auto camera = V4l2Camera::open({kLeft, kRight, 5, {}}, calibration(640, 480));
  ASSERT_TRUE(camera) << camera.error().message;
  const auto watched = watch(**camera, 3, 30s);
  ASSERT_EQ(watched.pairs.size(), 3u) << watched.error;
  // 75 % colour bars: white at the left, black at the right.
  const auto image = watched.pairs[0].images.get()->left;
  const auto at = [&](int x) { return int{image.rgb[3 * std::size_t(240 * 640 + x)]}; };
  EXPECT_NEAR(at(40), 191, 2);
  EXPECT_NEAR(at(600), 0, 2);
}

}  // namespace
}  // namespace kaz::tests
