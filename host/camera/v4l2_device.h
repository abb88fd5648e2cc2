// One video device of Linux (V4L2): agrees on a mode, streams through mapped buffers.
// SPDX-License-Identifier: Apache-2.0
//
// The kernel's own interface (linux/videodev2.h), single-planar capture, memory-mapped buffers. A
// picture's time is the buffer's time stamp on CLOCK_MONOTONIC, which is the host's clock
// (docs/explanation/time.md).
// A stamp is either of the start of exposure or of the end of the frame, as the buffer's flag indicates;
// half of the exposure time, where the camera reports it (V4L2_CID_EXPOSURE_ABSOLUTE, read once at the
// start), is added or taken off to get the middle. A picture cannot be exposed after it arrived: where a
// driver reports so, it gets the time of arrival, and is counted. The readout time of a rolling shutter is
// not available from any interface and is ignored.
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
  int width = 0, height = 0;          // px, exactly these
  double rate_hz = 30;                // pictures a second; the nearest rate of the camera is used
  std::optional<PixelFormat> format;  // empty: the best format that reaches the rate
};

// Error message, one sentence, for a failure of `doing` (as in "asking for its format") at `path`: no such
// device, no permission, busy, unplugged, no bandwidth left.
Error v4l2_error(const std::string& path, const std::string& doing, int error_number);

// Meaning of a driver's time stamps. `arrival`: they are not of CLOCK_MONOTONIC; the time at which the
// picture was read from the driver is used instead.
enum class Stamp : std::uint8_t { start_of_exposure, end_of_frame, arrival };
// Middle of an exposure that took `exposure_time`, zero if that is unknown.
Time middle_of_exposure(Time stamp, Stamp kind, Time exposure_time);

class V4l2Device {
 public:
  // Opens the device and negotiates a mode. Errors, a sentence each: those of v4l2_error(); no video device;
  // a node without pictures; planes in several buffers only; no supported format; not that size.
  static Result<std::unique_ptr<V4l2Device>> open(const std::string& path,
                                                  const V4l2Wanted& wanted);
  ~V4l2Device();
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  // Starts the stream. Errors: busy, no bandwidth on the bus, no memory for buffers.
  Result<void> start();

  enum class Taken { picture, damaged, nothing };
  // Never blocks. `damaged`: the driver flagged the buffer as corrupt, or it is empty. An error means that
  // no more pictures will come (unplugged, fatal error of the driver).
  Result<Taken> take(RawFrame& frame);

  const std::string& path() const { return path_; }
  int descriptor() const { return descriptor_; }  // readable when take() has something
  const RawLayout& layout() const { return layout_; }
  double rate_hz() const { return rate_hz_; }  // as negotiated; 0 if the driver does not report it
  // Pictures that the driver lost, by the gaps in its sequence numbers.
  std::uint64_t lost() const { return lost_; }
  Stamp stamp() const { return stamp_; }  // of the last picture
  // Pictures whose stamp was of a time after their arrival.
  std::uint64_t ahead() const { return ahead_; }

 private:
  struct Buffer {
    void* start = nullptr;
    std::size_t size = 0;
  };
  V4l2Device(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  int control(unsigned long request, void* argument) const;  // 0, or the error's number
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
