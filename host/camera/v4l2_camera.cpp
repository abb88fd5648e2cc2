// V4L2 stereo camera: one thread polls both devices.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/v4l2_camera.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "host/link/wall_clock.h"
#include "shared/base/number_text.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::host {
namespace {

constexpr std::array kSides{EyeSide::left, EyeSide::right};

std::size_t index(EyeSide side) {
  return static_cast<std::size_t>(side);
}

// Of the slower camera; a driver that reports no rate is assumed to have the usual one.
Time half_interval(const V4l2Device& left, const V4l2Device& right) {
  const auto rate = [](const V4l2Device& device) {
    return device.rate_hz() > 0 ? device.rate_hz() : 30.0;
  };
  return from_seconds(0.5 / std::min(rate(left), rate(right)));
}

}  // namespace

Result<V4l2Source> parse_v4l2_source(const std::string& text) {
  const auto wrong = [&](const std::string& why) {
    return fail(Fault::usage, shown_text(text) + ": " + why +
                                  "; give v4l2:LEFT,RIGHT[,fps=N][,format=yuyv|rgb24|mjpeg|grey], "
                                  "as in v4l2:/dev/video0,/dev/video2");
  };
  if (!text.starts_with(kV4l2)) return wrong("unknown camera kind");
  V4l2Source source;
  std::vector<std::string> parts;
  for (std::size_t at = kV4l2.size(); at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    parts.push_back(text.substr(at, comma - at));
    at = comma + 1;
  }
  if (parts.size() < 2 || parts[0].empty() || parts[1].empty())
    return wrong("two devices are needed");
  source.left = parts[0];
  source.right = parts[1];
  if (source.left == source.right) return wrong("left and right are the same device");
  for (std::size_t i = 2; i < parts.size(); ++i) {
    const std::string& part = parts[i];
    if (part.starts_with("fps=")) {
      const auto rate = parse_number<double>(std::string_view(part).substr(4));
      if (!rate || *rate < 1 || *rate > 1000)
        return wrong("'" + shown_text(part) + "': the rate must be 1 to 1000");
      source.rate_hz = *rate;
    } else if (part.starts_with("format=")) {
      source.format = pixel_format_by_name(std::string_view(part).substr(7));
      if (!source.format) return wrong("'" + shown_text(part) + "' is not a supported format");
    } else {
      return wrong("'" + shown_text(part) + "' is unknown");
    }
  }
  return source;
}

Result<std::unique_ptr<V4l2Camera>> V4l2Camera::open(const V4l2Source& source,
                                                     const vision::StereoCalibration& calibration,
                                                     const V4l2Options& options) {
  Devices devices;
  const V4l2Wanted wanted{calibration.width, calibration.height, source.rate_hz, source.format};
  for (const EyeSide side : kSides) {
    auto opened =
        KAZ_TRY(V4l2Device::open(side == EyeSide::left ? source.left : source.right, wanted));
    devices[index(side)] = std::move(opened);
  }
  for (const auto& device : devices) KAZ_TRY(device->start());
  const int wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake < 0)
    return fail(Fault::environment, std::string("cannot create an eventfd for the cameras: ") +
                                        std::strerror(errno) + "; close some programs");
  const Time tolerance =
      options.tolerance > Time{} ? options.tolerance : half_interval(*devices[0], *devices[1]);
  return std::unique_ptr<V4l2Camera>(
      new V4l2Camera(std::move(devices), wake, calibration, tolerance, options.silence));
}

V4l2Camera::V4l2Camera(Devices devices, int wake, const vision::StereoCalibration& calibration,
                       Time tolerance, Time silence)
    : devices_(std::move(devices)),
      wake_(wake),
      model_(calibration.rectified),
      rectifier_(calibration),
      silence_(silence),
      pairing_(tolerance) {
  statistics_.tolerance = tolerance;
  reader_ = std::thread([this] { read_devices(); });
}

V4l2Camera::~V4l2Camera() {
  eventfd_write(wake_, 1);
  reader_.join();
  close(wake_);
}

std::string V4l2Camera::mode(EyeSide side) const {
  const V4l2Device& device = *devices_[index(side)];
  char text[80];
  std::snprintf(text, sizeof text, "%d x %d %s, %.4g Hz", device.layout().width,
                device.layout().height, pixel_format_name(device.layout().format).data(),
                device.rate_hz());
  return text;
}

void V4l2Camera::stop(Error error) {
  const std::lock_guard lock(mutex_);
  stopped_ = std::move(error);
}

void V4l2Camera::read_devices() {
  paired_ = WallClock().now();
  heard_.fill(paired_);
  while (true) {
    std::array<pollfd, 3> watched{pollfd{devices_[0]->descriptor(), POLLIN, 0},
                                  pollfd{devices_[1]->descriptor(), POLLIN, 0},
                                  pollfd{wake_, POLLIN, 0}};
    const Time deadline = std::min(heard_[0], heard_[1]) + silence_;
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - WallClock().now()).count();
    const int ready = ::poll(watched.data(), watched.size(), static_cast<int>(std::max(left, 0L)));
    if (ready < 0 && errno != EINTR)
      return stop(
          {Fault::environment, std::string("the cameras stopped: ") + std::strerror(errno)});
    if (ready > 0 && watched[2].revents != 0) return;
    for (const EyeSide side : kSides) {
      const short events = ready > 0 ? watched[index(side)].revents : short{0};
      if (events != 0 && !take_all(side, (events & (POLLERR | POLLHUP | POLLNVAL)) != 0)) return;
    }
    while (const auto pair = pairing_.next()) deliver(*pair);
    {
      const std::lock_guard lock(mutex_);
      count();
    }
    if (!still_alive()) return;
  }
}

bool V4l2Camera::still_alive() {
  const Time now = WallClock().now();
  char text[240];
  for (const EyeSide side : kSides) {
    if (now < heard_[index(side)] + silence_) continue;
    std::snprintf(text, sizeof text,
                  " stopped: no picture came for %.3g s; check its cable and start again",
                  seconds(silence_));
    stop({Fault::environment, "camera " + devices_[index(side)]->path() + text});
    return false;
  }
  if (now < paired_ + silence_) return true;
  std::snprintf(text, sizeof text,
                " stopped: pictures come, but for %.3g s there was no valid pair with at most "
                "%.3g ms between its pictures; try another format or fps",
                seconds(silence_), 1e3 * seconds(pairing_.tolerance()));
  stop({Fault::environment,
        "cameras " + devices_[0]->path() + " and " + devices_[1]->path() + text});
  return false;
}

// Reads all available pictures of one device. False: it has stopped. `must_have_some`: poll() signalled an
// error, whose cause only a read returns.
bool V4l2Camera::take_all(EyeSide side, bool must_have_some) {
  V4l2Device& device = *devices_[index(side)];
  while (true) {
    RawFrame frame;
    const auto taken = device.take(frame);
    if (!taken) {
      stop(taken.error());
      return false;
    }
    if (*taken == V4l2Device::Taken::nothing) break;
    must_have_some = false;
    heard_[index(side)] = WallClock().now();
    if (*taken == V4l2Device::Taken::picture) pairing_.add(side, std::move(frame));
    const std::lock_guard lock(mutex_);
    if (*taken == V4l2Device::Taken::damaged) ++statistics_.damaged;
  }
  if (must_have_some)
    stop({Fault::environment, "camera " + device.path() +
                                  " stopped: its driver reports an error; plug it in again and "
                                  "start again"});
  return !must_have_some;
}

void V4l2Camera::count() {
  statistics_.without_partner =
      pairing_.without_partner(EyeSide::left) + pairing_.without_partner(EyeSide::right);
  statistics_.out_of_order =
      pairing_.out_of_order(EyeSide::left) + pairing_.out_of_order(EyeSide::right);
  statistics_.lost = devices_[0]->lost() + devices_[1]->lost();
  statistics_.ahead = devices_[0]->ahead() + devices_[1]->ahead();
  statistics_.stamps = {devices_[0]->stamp(), devices_[1]->stamp()};
}

void V4l2Camera::deliver(const RawPair& raw) {
  auto images = std::make_shared<vision::StereoImages>();
  const bool valid =
      convert_picture(raw.left.bytes, devices_[0]->layout(), scratch_.left).has_value() &&
      convert_picture(raw.right.bytes, devices_[1]->layout(), scratch_.right).has_value();
  if (valid) rectifier_.rectify(scratch_, *images);

  const std::lock_guard lock(mutex_);
  count();
  const std::uint64_t sequence = sequence_++;
  if (!valid) {
    ++statistics_.damaged;
    return;
  }
  vision::StereoPair pair;
  pair.info.sequence = sequence;
  pair.info.exposure = raw.exposure();
  pair.info.camera = model_;
  std::promise<std::shared_ptr<const vision::StereoImages>> pixels;
  pixels.set_value(std::move(images));
  pair.images = pixels.get_future().share();
  paired_ = WallClock().now();
  ++statistics_.pairs;
  statistics_.largest_gap = std::max(statistics_.largest_gap, raw.gap());
  waiting_.push_back(std::move(pair));
  if (waiting_.size() > kMostWaiting) {
    waiting_.pop_front();
    ++statistics_.not_taken;
  }
}

Result<std::optional<vision::StereoPair>> V4l2Camera::poll() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) {
    if (stopped_) return tl::unexpected(*stopped_);
    return std::nullopt;
  }
  vision::StereoPair pair = std::move(waiting_.front());
  waiting_.pop_front();
  return pair;
}

V4l2Statistics V4l2Camera::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

std::string V4l2Camera::summary() const {
  const V4l2Statistics counted = statistics();
  const std::pair<std::uint64_t, const char*> losses[] = {
      {counted.not_taken, "pairs dropped because a newer pair came"},
      {counted.without_partner, "pictures without partner"},
      {counted.damaged, "pictures damaged"},
      {counted.out_of_order, "pictures out of order"},
      {counted.lost, "pictures lost by the driver"},
      {counted.ahead, "pictures with a time stamp later than their arrival"}};
  std::string text = mode(EyeSide::left) + "; " + std::to_string(counted.pairs) + " pairs";
  for (const auto& [count, what] : losses)
    if (count > 0) text += ", " + std::to_string(count) + " " + what;
  char gap[80];
  std::snprintf(gap, sizeof gap, "; at most %.1f ms between the eyes (%.1f ms allowed)",
                1e3 * seconds(counted.largest_gap), 1e3 * seconds(counted.tolerance));
  return text + gap;
}

}  // namespace kaz::host
