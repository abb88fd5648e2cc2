// One Linux video device (V4L2): negotiates a mode and streams through mapped buffers.
// SPDX-License-Identifier: Apache-2.0
//
// Uses the kernel interface (linux/videodev2.h) with single-planar capture and memory-mapped buffers. A
// picture's time is the buffer's time stamp on CLOCK_MONOTONIC, the host's clock (docs/explanation/time.md).
// The buffer's flag shows whether a stamp marks the start of the exposure or the end of the frame. The
// exposure time is read once, at the start of the stream (V4L2_CID_EXPOSURE_ABSOLUTE). The middle of the
// exposure is computed with half of the exposure time. This half is added to a stamp at the start of the
// exposure, and subtracted from any other stamp. A picture cannot be exposed after its arrival. If the
// computed middle of the exposure is later than the arrival, the time of arrival is used instead. ahead()
// counts these pictures. No interface reports the readout time of a rolling shutter, so the readout time is
// ignored.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/camera/raw_picture.h"
#include "host/camera/stereo_pairing.h"

namespace kaz::host {

struct V4l2Wanted {
  int width = 0, height = 0;  // px; the camera must support exactly this size
  double rate_hz = 30;        // pictures per second; the camera's nearest rate is used
  // Empty: selects the first format in which the camera reaches the rate. The order of formats is yuyv,
  // rgb24, mjpeg, grey.
  std::optional<PixelFormat> format;
};

// Returns the error for a failed operation on the device at `path`. `doing` describes the operation, such as
// "asking for its format". The message states the cause: no such device, no permission, busy, unplugged, or
// no bandwidth left.
Error v4l2_error(const std::string& path, const std::string& doing, int error_number);

// Meaning of a driver's time stamps. `arrival`: the driver's stamps are not on CLOCK_MONOTONIC, so the stamp
// is the time at which the picture was read.
enum class Stamp : std::uint8_t { start_of_exposure, end_of_frame, arrival };
// Returns the middle of an exposure. `exposure_time` is zero if unknown.
Time middle_of_exposure(Time stamp, Stamp kind, Time exposure_time);

class V4l2Device {
 public:
  // Opens the device and negotiates a mode. Returns the errors of v4l2_error(). Also fails if `path` is not a
  // video device, or if the device cannot capture pictures. Also fails if the device has no single-planar
  // pictures of the wanted size in a supported format.
  static Result<std::unique_ptr<V4l2Device>> open(const std::string& path,
                                                  const V4l2Wanted& wanted);
  ~V4l2Device();
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  // Starts the stream. Fails if the device is busy, or if bus bandwidth or buffer memory is exhausted.
  Result<void> start();

  enum class Taken { picture, damaged, nothing };
  // Takes a picture without blocking. `damaged`: the driver flagged the buffer as corrupt, or the buffer is
  // empty. An error means that no more pictures will come (unplugged, or fatal driver error).
  Result<Taken> take(RawFrame& frame);

  const std::string& path() const { return path_; }
  int descriptor() const { return descriptor_; }  // readable when take() has a picture
  const RawLayout& layout() const { return layout_; }
  // Negotiated rate; 0 if the driver does not report a rate.
  double rate_hz() const { return rate_hz_; }
  // Number of pictures that the driver lost, computed from gaps in the driver's sequence numbers.
  std::uint64_t lost() const { return lost_; }
  Stamp stamp() const { return stamp_; }  // meaning of the newest picture's time stamp
  // Number of pictures for which the driver's time stamp gave an exposure later than the picture's arrival.
  std::uint64_t ahead() const { return ahead_; }

 private:
  struct Buffer {
    void* start = nullptr;
    std::size_t size = 0;
  };
  V4l2Device(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  int control(unsigned long request, void* argument) const;  // returns 0 or errno
  Result<void> check_kind() const;
  std::vector<std::uint32_t> formats() const;
  std::string sizes(std::uint32_t format) const;
  Result<void> agree(const V4l2Wanted& wanted);
  bool try_size(std::uint32_t format, const V4l2Wanted& wanted) const;
  Result<void> set_mode(PixelFormat format, const V4l2Wanted& wanted);
  double set_rate(double wanted_hz) const;
  Result<void> map_buffers();
  Time read_exposure_time() const;
  Error error(const std::string& doing, int number) const;

  std::string path_;
  int descriptor_;
  RawLayout layout_;
  double rate_hz_ = 0;
  std::vector<Buffer> buffers_;
  Time exposure_time_{};
  Stamp stamp_ = Stamp::end_of_frame;
  std::optional<std::uint32_t> last_sequence_;
  std::uint64_t lost_ = 0, ahead_ = 0;
};

}  // namespace kaz::host
