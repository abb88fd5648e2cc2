// Two cameras at this machine as one stereo camera, over Linux's video interface (V4L2).
// SPDX-License-Identifier: Apache-2.0
//
// A thread reads the pictures of both devices, pairs them by time, converts and rectifies them. The cameras
// need not be synchronised; the two pictures of a moving object are then exposed at times up to the
// tolerance apart, which causes errors of its depth.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "host/camera/stereo_pairing.h"
#include "host/camera/v4l2_device.h"
#include "vision/calibration/calibration.h"
#include "vision/calibration/rectify.h"
#include "vision/image/frame.h"

namespace kaz::host {

struct V4l2Source {
  std::string left, right;  // as /dev/video0; names under /dev/v4l/by-path outlive a reboot
  double rate_hz = 30;
  std::optional<PixelFormat> format;
};

inline constexpr std::string_view kV4l2 = "v4l2:";

// "v4l2:LEFT,RIGHT[,fps=N][,format=yuyv|rgb24|mjpeg|grey]". Errors: usage.
Result<V4l2Source> parse_v4l2_source(const std::string& text);

struct V4l2Options {
  // Between the two pictures of a pair; 0: half the time between two pictures of the slower camera.
  Time tolerance{};
  // Time-out: a device without pictures for this long has stopped; so have both if there was no pair for
  // this long. Far longer than exposures in the dark.
  Time silence = std::chrono::seconds(2);
};

struct V4l2Statistics {
  std::uint64_t pairs = 0;            // returned by poll(), or queued
  std::uint64_t not_taken = 0;        // pairs dropped because poll() was called too rarely
  std::uint64_t without_partner = 0;  // pictures of either side
  std::uint64_t damaged = 0;          // pictures marked so by the driver, cut off, not decodable
  std::uint64_t out_of_order = 0;     // pictures whose time was not after the one before
  std::uint64_t lost = 0;             // by the driver, for lack of a buffer
  std::uint64_t ahead = 0;            // pictures stamped with a time after their arrival
  Time largest_gap{};                 // between the pictures of a pair
  Time tolerance{};
  std::array<Stamp, 2> stamps{};  // of left and right
};

class V4l2Camera final : public vision::Camera {
 public:
  // Size of the queue of pairs; if poll() is called too rarely, the oldest are dropped.
  static constexpr std::size_t kMostWaiting = 4;

  // Opens both at the calibration's size and starts them. Errors: V4l2Device::open(), start().
  static Result<std::unique_ptr<V4l2Camera>> open(const V4l2Source& source,
                                                  const vision::StereoCalibration& calibration,
                                                  const V4l2Options& options = {});
  ~V4l2Camera() override;
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  const vision::CameraModel& model() const override { return model_; }
  // Rectified pairs with their pixels. The error "camera PATH stopped: ..." once a device has stopped and
  // all earlier pairs were returned.
  Result<std::optional<vision::StereoPair>> poll() override;
  V4l2Statistics statistics() const;
  // Text for users: "412 pairs, 3 pictures without partner, ...".
  std::string summary() const;
  // Of the left and right device: "640 x 480 yuyv, 30 Hz".
  std::string mode(EyeSide side) const;

 private:
  using Devices = std::array<std::unique_ptr<V4l2Device>, 2>;
  V4l2Camera(Devices devices, int wake, const vision::StereoCalibration& calibration,
             Time tolerance, Time silence);
  void read_devices();
  bool take_all(EyeSide side, bool must_have_some);
  void deliver(const RawPair& raw);
  void count();  // under the lock
  bool still_alive();
  void stop(Error error);

  const Devices devices_;
  const int wake_;  // eventfd: ends the thread
  const vision::CameraModel model_;
  const vision::Rectifier rectifier_;
  const Time silence_;
  StereoPairing pairing_;         // of the thread
  std::array<Time, 2> heard_{};   // of the thread
  Time paired_{};                 // of the thread: when the last valid pair came
  vision::StereoImages scratch_;  // of the thread
  std::uint64_t sequence_ = 0;    // of the thread
  mutable std::mutex mutex_;
  std::deque<vision::StereoPair> waiting_;
  V4l2Statistics statistics_;
  std::optional<Error> stopped_;
  std::thread reader_;  // last: it uses all of the above
};

}  // namespace kaz::host
