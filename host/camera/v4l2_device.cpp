// V4L2 video device: modes, buffers, time stamps.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/v4l2_device.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "host/link/wall_clock.h"

namespace kaz::host {
namespace {

constexpr std::uint32_t kBuffers = 4;

// In order of preference: exact before packed, colour before grey.
constexpr std::array<std::pair<PixelFormat, std::uint32_t>, 4> kFormats{
    {{PixelFormat::yuyv, V4L2_PIX_FMT_YUYV},
     {PixelFormat::rgb24, V4L2_PIX_FMT_RGB24},
     {PixelFormat::mjpeg, V4L2_PIX_FMT_MJPEG},
     {PixelFormat::grey, V4L2_PIX_FMT_GREY}}};

std::uint32_t code_of(PixelFormat format) {
  return std::ranges::find(kFormats, format, &decltype(kFormats)::value_type::first)->second;
}

std::string code_text(std::uint32_t code) {
  std::string text;
  for (int i = 0; i < 4; ++i) text += static_cast<char>(code >> (8 * i) & 0x7F);
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::string size_text(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

template <class T>
T capture() {
  T value{};
  value.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  return value;
}

YuvMeaning meaning(const v4l2_pix_format& format) {
  std::uint32_t encoding = format.ycbcr_enc, range = format.quantization;
  if (encoding == V4L2_YCBCR_ENC_DEFAULT) encoding = V4L2_MAP_YCBCR_ENC_DEFAULT(format.colorspace);
  if (range == V4L2_QUANTIZATION_DEFAULT)
    range = V4L2_MAP_QUANTIZATION_DEFAULT(false, format.colorspace, encoding);
  return {encoding == V4L2_YCBCR_ENC_709 || encoding == V4L2_YCBCR_ENC_XV709,
          range == V4L2_QUANTIZATION_FULL_RANGE};
}

std::string refused(const std::string& path, const std::string& why) {
  return "no camera at " + path + ": " + why;
}

Stamp stamp_kind(std::uint32_t flags) {
  if ((flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
    return Stamp::arrival;
  return (flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE
             ? Stamp::start_of_exposure
             : Stamp::end_of_frame;
}

// Pixel formats of the device for an error message, at most kMaxListed.
std::string list_of(const std::vector<std::uint32_t>& codes) {
  constexpr std::size_t kMaxListed = 8;
  std::string list;
  for (std::size_t i = 0; i < std::min(kMaxListed, codes.size()); ++i)
    list += (i == 0 ? "" : ", ") + code_text(codes[i]);
  if (codes.size() > kMaxListed)
    list += " and " + std::to_string(codes.size() - kMaxListed) + " more";
  return codes.empty() ? "no format" : list;
}

}  // namespace

Time middle_of_exposure(Time stamp, Stamp kind, Time exposure_time) {
  return kind == Stamp::start_of_exposure ? stamp + exposure_time / 2 : stamp - exposure_time / 2;
}

Error v4l2_error(const std::string& path, const std::string& doing, int number) {
  const auto why = [&]() -> std::string {
    switch (number) {
      case ENOENT:
      case ENOTDIR:
        return "there is no such device; plug the camera in (`ls /dev/video*` lists the devices)";
      case EACCES:
      case EPERM:
        return "permission denied; become a member of the group video (`adduser USER video`) and "
               "log in again";
      case EBUSY:
        return "another program uses the camera; end that program (`fuser " + path +
               "` shows its process)";
      case ENODEV:
      case ENXIO:
        return "the camera was unplugged; plug it in and start again";
      case ENOSPC:
        return "the USB bus does not have enough bandwidth; plug the cameras into different ports, "
               "or use format=mjpeg or a lower fps";
      default:
        return doing + " failed (" + std::strerror(number) +
               "); unplug it, plug it in and start again";
    }
  };
  return {Fault::environment, refused(path, why())};
}

int V4l2Device::control(unsigned long request, void* argument) const {
  int result;
  do {
    result = ioctl(descriptor_, request, argument);
  } while (result < 0 && errno == EINTR);
  return result < 0 ? errno : 0;
}

Error V4l2Device::error(const std::string& doing, int number) const {
  return v4l2_error(path_, doing, number);
}

Result<std::unique_ptr<V4l2Device>> V4l2Device::open(const std::string& path,
                                                     const V4l2Wanted& wanted) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return tl::unexpected(v4l2_error(path, "opening it", errno));
  std::unique_ptr<V4l2Device> device(new V4l2Device(path, descriptor));
  KAZ_TRY(device->check_kind());
  KAZ_TRY(device->agree(wanted));
  return device;
}

V4l2Device::~V4l2Device() {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (!buffers_.empty()) control(VIDIOC_STREAMOFF, &type);
  for (const Buffer& buffer : buffers_) munmap(buffer.start, buffer.size);
  close(descriptor_);
}

Result<void> V4l2Device::check_kind() const {
  v4l2_capability capability{};
  const int number = control(VIDIOC_QUERYCAP, &capability);
  if (number == ENOTTY || number == EINVAL)
    return fail(Fault::environment, refused(path_, "this file is not a V4L2 video device"));
  if (number != 0) return tl::unexpected(error("querying its capabilities", number));
  const std::uint32_t can = capability.capabilities & V4L2_CAP_DEVICE_CAPS
                                ? capability.device_caps
                                : capability.capabilities;
  const std::string name(reinterpret_cast<const char*>(capability.card),
                         strnlen(reinterpret_cast<const char*>(capability.card), 32));
  if (can & V4L2_CAP_VIDEO_CAPTURE_MPLANE && !(can & V4L2_CAP_VIDEO_CAPTURE))
    return fail(Fault::environment,
                refused(path_, name + " delivers only multi-planar pictures, which are not "
                                      "supported; use a camera with the single-planar interface"));
  if (!(can & V4L2_CAP_VIDEO_CAPTURE) || !(can & V4L2_CAP_STREAMING))
    return fail(Fault::environment, refused(path_, "this node of " + name +
                                                       " delivers no pictures; use another node of "
                                                       "the camera (usually, the camera's first "
                                                       "node delivers the pictures)"));
  return {};
}

std::vector<std::uint32_t> V4l2Device::formats() const {
  std::vector<std::uint32_t> codes;
  auto format = capture<v4l2_fmtdesc>();
  for (; control(VIDIOC_ENUM_FMT, &format) == 0; ++format.index)
    codes.push_back(format.pixelformat);
  return codes;
}

std::string V4l2Device::sizes(std::uint32_t format) const {
  std::string text;
  v4l2_frmsizeenum size{};
  size.pixel_format = format;
  for (; size.index < 32 && control(VIDIOC_ENUM_FRAMESIZES, &size) == 0; ++size.index) {
    text += text.empty() ? "" : ", ";
    if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE)
      return size_text(size.stepwise.min_width, size.stepwise.min_height) + " to " +
             size_text(size.stepwise.max_width, size.stepwise.max_height);
    text += size_text(size.discrete.width, size.discrete.height);
  }
  return text.empty() ? "unknown sizes" : text;
}

bool V4l2Device::try_size(std::uint32_t code, const V4l2Wanted& wanted) const {
  auto format = capture<v4l2_format>();
  format.fmt.pix.width = static_cast<std::uint32_t>(wanted.width);
  format.fmt.pix.height = static_cast<std::uint32_t>(wanted.height);
  format.fmt.pix.pixelformat = code;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  return control(VIDIOC_TRY_FMT, &format) == 0 && format.fmt.pix.pixelformat == code &&
         format.fmt.pix.width == static_cast<std::uint32_t>(wanted.width) &&
         format.fmt.pix.height == static_cast<std::uint32_t>(wanted.height) &&
         format.fmt.pix.field == V4L2_FIELD_NONE;
}

Result<void> V4l2Device::agree(const V4l2Wanted& wanted) {
  const auto offered = formats();
  std::vector<PixelFormat> known, fitting;
  for (const auto& [format, code] : kFormats) {
    if (std::ranges::find(offered, code) == offered.end()) continue;
    if (wanted.format && *wanted.format != format) continue;
    known.push_back(format);
    if (try_size(code, wanted)) fitting.push_back(format);
  }
  if (known.empty())
    return fail(Fault::environment,
                refused(path_, "formats that the camera offers: " + list_of(offered) + "; " +
                                   (wanted.format ? std::string(pixel_format_name(*wanted.format)) +
                                                        " was requested"
                                                  : "YUYV, RGB24, MJPEG or GREY is needed")));
  if (fitting.empty())
    return fail(
        Fault::environment,
        refused(path_, "the calibration is for pictures of " +
                           size_text(static_cast<std::uint32_t>(wanted.width),
                                     static_cast<std::uint32_t>(wanted.height)) +
                           ", but the camera does not offer this size; the camera offers " +
                           sizes(code_of(known.front())) + ": calibrate at one of these sizes"));
  // Some cameras reach the rate only with compressed pictures.
  PixelFormat best = fitting.front();
  double best_hz = -1;
  for (const PixelFormat format : fitting) {
    if (auto set = set_mode(format, wanted); !set) return set;
    if (rate_hz_ > 1.1 * best_hz || best_hz < 0) {
      best = format;
      best_hz = rate_hz_;
    }
    if (rate_hz_ == 0 || rate_hz_ >= 0.95 * wanted.rate_hz) break;
  }
  return best == layout_.format ? Result<void>{} : set_mode(best, wanted);
}

Result<void> V4l2Device::set_mode(PixelFormat format, const V4l2Wanted& wanted) {
  auto mode = capture<v4l2_format>();
  mode.fmt.pix.width = static_cast<std::uint32_t>(wanted.width);
  mode.fmt.pix.height = static_cast<std::uint32_t>(wanted.height);
  mode.fmt.pix.pixelformat = code_of(format);
  mode.fmt.pix.field = V4L2_FIELD_NONE;
  if (const int number = control(VIDIOC_S_FMT, &mode))
    return tl::unexpected(error("setting its format", number));
  layout_ = {format, wanted.width, wanted.height, mode.fmt.pix.bytesperline, meaning(mode.fmt.pix)};
  rate_hz_ = set_rate(wanted.rate_hz);
  return {};
}

double V4l2Device::set_rate(double wanted_hz) const {
  auto parameters = capture<v4l2_streamparm>();
  if (control(VIDIOC_G_PARM, &parameters) != 0) return 0;
  auto& interval = parameters.parm.capture.timeperframe;
  if (parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) {
    interval = {1000, static_cast<std::uint32_t>(std::lround(1000 * wanted_hz))};
    control(VIDIOC_S_PARM, &parameters);  // what came of it is read from what it leaves
  }
  return interval.numerator == 0 ? 0 : double(interval.denominator) / interval.numerator;
}

Result<void> V4l2Device::map_buffers() {
  auto request = capture<v4l2_requestbuffers>();
  request.count = kBuffers;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int number = control(VIDIOC_REQBUFS, &request))
    return tl::unexpected(error("requesting buffers", number));
  for (std::uint32_t i = 0; i < request.count; ++i) {
    auto buffer = capture<v4l2_buffer>();
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = i;
    if (const int number = control(VIDIOC_QUERYBUF, &buffer))
      return tl::unexpected(error("querying a buffer", number));
    void* start = mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_,
                       static_cast<off_t>(buffer.m.offset));
    if (start == MAP_FAILED) return tl::unexpected(error("mapping a buffer", errno));
    buffers_.push_back({start, buffer.length});
    if (const int number = control(VIDIOC_QBUF, &buffer))
      return tl::unexpected(error("queuing a buffer", number));
  }
  return {};
}

Time V4l2Device::read_exposure_time() const {
  v4l2_control exposure{V4L2_CID_EXPOSURE_ABSOLUTE, 0};
  if (control(VIDIOC_G_CTRL, &exposure) != 0 || exposure.value <= 0) return {};
  const Time time = std::chrono::microseconds(100) * exposure.value;
  // An exposure cannot be longer than a frame: such a value is of a control without effect.
  return rate_hz_ > 0 && seconds(time) > 1 / rate_hz_ ? Time{} : time;
}

Result<void> V4l2Device::start() {
  if (auto mapped = map_buffers(); !mapped) return mapped;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int number = control(VIDIOC_STREAMON, &type))
    return tl::unexpected(error("starting its stream", number));
  exposure_time_ = read_exposure_time();
  return {};
}

Result<V4l2Device::Taken> V4l2Device::take(RawFrame& frame) {
  auto buffer = capture<v4l2_buffer>();
  buffer.memory = V4L2_MEMORY_MMAP;
  const int number = control(VIDIOC_DQBUF, &buffer);
  if (number == EAGAIN) return Taken::nothing;
  const auto stopped = [&](int why) {
    const bool gone = why == ENODEV || why == ENXIO;
    return fail(Fault::environment,
                "camera " + path_ + " stopped: " +
                    (gone ? "the camera was unplugged"
                          : std::string("its driver failed (") + std::strerror(why) + ")") +
                    "; plug it in and start again");
  };
  if (number != 0) return stopped(number);
  // Some drivers leave the number alone; it counts no lost pictures then.
  if (last_sequence_ && buffer.sequence > *last_sequence_)
    lost_ += buffer.sequence - *last_sequence_ - 1;
  last_sequence_ = buffer.sequence;

  const bool valid = !(buffer.flags & V4L2_BUF_FLAG_ERROR) && buffer.bytesused > 0 &&
                     buffer.index < buffers_.size();
  if (valid) {
    const auto* bytes = static_cast<const std::uint8_t*>(buffers_[buffer.index].start);
    frame.bytes.assign(
        bytes, bytes + std::min<std::size_t>(buffer.bytesused, buffers_[buffer.index].size));
    stamp_ = stamp_kind(buffer.flags);
    const Time arrived = WallClock().now();
    const Time stamp = stamp_ == Stamp::arrival
                           ? arrived
                           : Time(std::chrono::seconds(buffer.timestamp.tv_sec) +
                                  std::chrono::microseconds(buffer.timestamp.tv_usec));
    frame.exposure = middle_of_exposure(stamp, stamp_, exposure_time_);
    if (frame.exposure > arrived) {
      frame.exposure = arrived;
      ++ahead_;
    }
  }
  if (const int failed = control(VIDIOC_QBUF, &buffer)) return stopped(failed);
  return valid ? Taken::picture : Taken::damaged;
}

}  // namespace kaz::host
