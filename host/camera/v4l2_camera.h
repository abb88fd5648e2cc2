// Combines two cameras of this machine into one stereo camera, over Linux's video interface (V4L2).
// SPDX-License-Identifier: Apache-2.0
//
// A thread reads the pictures of both devices, pairs them by time, converts and rectifies them. The cameras
// need not be synchronized. Without synchronization, the exposure times of a pair can differ by up to the
// tolerance. A moving object then has a depth error.
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
  std::string left, right;  // such as /dev/video0; names in /dev/v4l/by-path survive a reboot
  double rate_hz = 30;
  std::optional<PixelFormat> format;
};

inline constexpr std::string_view kV4l2 = "v4l2:";

// Parses "v4l2:LEFT,RIGHT[,fps=N][,format=yuyv|rgb24|mjpeg|grey]". Returns usage errors.
Result<V4l2Source> parse_v4l2_source(const std::string& text);

struct V4l2Options {
  // Maximum time between the two pictures of a pair; 0: half the picture interval of the slower camera.
  Time tolerance{};
  // Timeout: a device that delivers no picture for this long counts as stopped. Both devices count as stopped
  // if no valid pair came for this long. The timeout is much longer than any exposure, also in the dark.
  Time silence = std::chrono::seconds(2);
};

struct V4l2Statistics {
  std::uint64_t pairs = 0;            // pairs delivered to the queue of poll()
  std::uint64_t not_taken = 0;        // pairs dropped because poll() was called too rarely
  std::uint64_t without_partner = 0;  // pictures of either side that got no partner
  std::uint64_t damaged =
      0;  // pictures that the driver reports as damaged, or that cannot be decoded
  std::uint64_t out_of_order = 0;  // pictures not newer than the previous one of their side
  std::uint64_t lost = 0;          // pictures lost by the driver, for lack of a buffer
  std::uint64_t ahead = 0;         // pictures with a computed exposure later than their arrival
  Time largest_gap{};              // longest time between the exposures of a pair
  Time tolerance{};
  std::array<Stamp, 2> stamps{};  // kind of time stamps, left and right
};

class V4l2Camera final : public vision::Camera {
 public:
  // Size of the queue of pairs. If poll() is called too rarely, the oldest pairs are dropped.
  static constexpr std::size_t kMostWaiting = 4;

  // Opens both devices with the picture size of the calibration, and starts both streams. Returns the errors
  // of V4l2Device::open() and start().
  static Result<std::unique_ptr<V4l2Camera>> open(const V4l2Source& source,
                                                  const vision::StereoCalibration& calibration,
                                                  const V4l2Options& options = {});
  ~V4l2Camera() override;
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  const vision::CameraModel& model() const override { return model_; }
  // Returns rectified pairs with their pixels. Fails with "camera PATH stopped: ..." once a device has
  // stopped and all earlier pairs were returned.
  Result<std::optional<vision::StereoPair>> poll() override;
  V4l2Statistics statistics() const;
  // Text for users: "412 pairs, 3 pictures without partner, ...".
  std::string summary() const;
  // Mode of one device: "640 x 480 yuyv, 30 Hz".
  std::string mode(EyeSide side) const;

 private:
  using Devices = std::array<std::unique_ptr<V4l2Device>, 2>;
  V4l2Camera(Devices devices, int wake, const vision::StereoCalibration& calibration,
             Time tolerance, Time silence);
  void read_devices();
  bool take_all(EyeSide side, bool must_have_some);
  void deliver(const RawPair& raw);
  void count();  // the caller must hold mutex_
  bool still_alive();
  void stop(Error error);

  const Devices devices_;
  const int wake_;  // eventfd that ends the thread
  const vision::CameraModel model_;
  const vision::Rectifier rectifier_;
  const Time silence_;
  StereoPairing pairing_;        // used only by the reader thread
  std::array<Time, 2> heard_{};  // used only by the reader thread
  Time paired_{};  // used only by the reader thread; time at which the last valid pair came
  vision::StereoImages scratch_;  // used only by the reader thread
  std::uint64_t sequence_ = 0;    // used only by the reader thread
  mutable std::mutex mutex_;
  std::deque<vision::StereoPair> waiting_;
  V4l2Statistics statistics_;
  std::optional<Error> stopped_;
  std::thread reader_;  // must be the last member: the thread uses the members above
};

}  // namespace kaz::host
