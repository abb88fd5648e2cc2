// Two cameras at this machine as one stereo camera, over Linux's video interface (V4L2).
// SPDX-License-Identifier: Apache-2.0
//
// A thread of its own takes the pictures of both devices, pairs them by time, converts and rectifies
// them. The cameras need not be synchronized; what moves is then seen by both eyes at moments up to the
// tolerance apart, which shows as wrong depth.
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
  // A device that is silent for so long has stopped; so have both when for so long no two pictures
  // were a pair. Long exposures in the dark stay far below it.
  Time silence = std::chrono::seconds(2);
};

struct V4l2Statistics {
  std::uint64_t pairs = 0;            // given, or waiting to be taken
  std::uint64_t not_taken = 0;        // pairs dropped because poll() was called too seldom
  std::uint64_t without_partner = 0;  // pictures of either side
  std::uint64_t damaged = 0;          // pictures marked so by the driver, cut off, not decodable
  std::uint64_t out_of_order = 0;     // pictures whose time was not after the one before
  std::uint64_t lost = 0;             // by the driver: nobody had a buffer for them
  std::uint64_t ahead = 0;            // pictures stamped with a time after their arrival
  Time largest_gap{};                 // between the pictures of a pair
  Time tolerance{};
  std::array<Stamp, 2> stamps{};  // of left and right
};

class V4l2Camera final : public vision::Camera {
 public:
  // Pairs that wait here at most; older ones are dropped when the user of the camera is slow.
  static constexpr std::size_t kMostWaiting = 4;

  // Opens both at the calibration's size and starts them. Errors: V4l2Device::open(), start().
  static Result<std::unique_ptr<V4l2Camera>> open(const V4l2Source& source,
                                                  const vision::StereoCalibration& calibration,
                                                  const V4l2Options& options = {});
  ~V4l2Camera() override;
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  const vision::CameraModel& model() const override { return model_; }
  // Rectified pairs; their pixels are there. Once a device has stopped and what came before has been
  // taken: "camera PATH stopped: ...".
  Result<std::optional<vision::StereoPair>> poll() override;
  V4l2Statistics statistics() const;
  // For people: "412 pairs, 3 pictures without partner, ...".
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
