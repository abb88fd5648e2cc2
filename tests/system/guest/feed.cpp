// Inside a virtual machine: sends its clock out, and puts the eyes' pictures into its video devices.
// SPDX-License-Identifier: Apache-2.0
//
// feed clock N: CLOCK_MONOTONIC, 8 bytes, each millisecond, to each of N robots
// (sim/runtime/serving/followed_clock.h).
// feed slcan: CAN interfaces can0 and can1, joined by serial lines.
// feed eyes PORT LEFT RIGHT: pairs of shared/base/camera_stream.hpp from PORT into two outputs of
// v4l2loopback, with the middle of the exposure as time stamp, no sooner than the stream's latency allows.
// SIGUSR1: the outputs are closed, as if the cameras were unplugged; once more: opened again.
#include <fcntl.h>
#include <linux/tty.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sched.h>
#include <sys/io.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/camera_stream.hpp"

namespace {

constexpr std::int64_t kSecond = 1'000'000'000, kPeriod = 1'000'000;
constexpr unsigned short kClockPort = 0xE9;  // of the first robot, with those of others behind it

[[noreturn]] void die(const std::string& what) {
  std::fprintf(stderr, "feed: %s: %s\n", what.c_str(), std::strerror(errno));
  std::exit(1);
}

int open_or_die(const char* path, int how) {
  const int fd = open(path, how | O_CLOEXEC);
  if (fd < 0) die(path);
  return fd;
}

timespec as_timespec(std::int64_t ns) {
  return {static_cast<time_t>(ns / kSecond), static_cast<long>(ns % kSecond)};
}

std::int64_t now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{t.tv_sec} * kSecond + t.tv_nsec;
}

void sleep_until(std::int64_t ns) {
  const timespec t = as_timespec(ns);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) continue;
}

// Ports of QEMU's isa-debugcon: writing a byte stops this machine until there is room for it outside.
int send_clock(unsigned short robots) {
  if (ioperm(kClockPort, robots, 1) != 0) die("no access to the port of the clock");
  // Above every other program: the world outside stands still between two messages.
  sched_param first{};
  first.sched_priority = 50;
  if (sched_setscheduler(0, SCHED_FIFO, &first) != 0) die("no priority of real time");
  for (std::int64_t next = now();;) {
    const std::int64_t time = now();
    std::array<unsigned char, sizeof time> bytes{};
    std::memcpy(bytes.data(), &time, sizeof time);
    for (unsigned short robot = 0; robot < robots; ++robot)
      for (const unsigned char byte : bytes) outb(byte, kClockPort + robot);
    next = std::max(next + kPeriod, time);
    sleep_until(next);
  }
}

void read_whole(int fd, void* to, std::size_t size) {
  auto* bytes = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t got = read(fd, bytes, size);
    if (got > 0) {
      bytes += got;
      size -= static_cast<std::size_t>(got);
    } else if (got < 0 && errno != EINTR && errno != EAGAIN) {
      die("no picture");
    } else if (got == 0) {
      usleep(2000);  // nobody at the other end of the port
    }
  }
}

// One video device as its writer.
class Output {
 public:
  Output(const char* path, std::uint32_t width, std::uint32_t height)
      : fd_(open_or_die(path, O_RDWR)) {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    format.fmt.pix.width = width;
    format.fmt.pix.height = height;
    format.fmt.pix.pixelformat = V4L2_PIX_FMT_RGB24;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    format.fmt.pix.bytesperline = 3 * width;
    format.fmt.pix.sizeimage = 3 * width * height;
    format.fmt.pix.colorspace = V4L2_COLORSPACE_SRGB;
    control(VIDIOC_S_FMT, &format, "its format");
    v4l2_streamparm parameters{};
    parameters.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    parameters.parm.output.timeperframe = {1, 30};
    control(VIDIOC_S_PARM, &parameters, "its rate");
    v4l2_requestbuffers request{};
    request.count = kBuffers;
    request.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    request.memory = V4L2_MEMORY_MMAP;
    control(VIDIOC_REQBUFS, &request, "its buffers");
    for (std::uint32_t i = 0; i < kBuffers; ++i) {
      v4l2_buffer buffer = one(i);
      control(VIDIOC_QUERYBUF, &buffer, "a buffer");
      void* start = mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd_,
                         static_cast<off_t>(buffer.m.offset));
      if (start == MAP_FAILED) die("mapping a buffer");
      starts_.at(i) = start;
      length_ = buffer.length;
    }
    int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    control(VIDIOC_STREAMON, &type, "its stream");
  }

  ~Output() {
    int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    ioctl(fd_, VIDIOC_STREAMOFF, &type);
    for (void* start : starts_) munmap(start, length_);
    close(fd_);
  }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  void show(const std::vector<std::uint8_t>& picture, std::int64_t exposure_ns) {
    v4l2_buffer buffer = one(next_);
    std::memcpy(starts_.at(next_), picture.data(), picture.size());
    buffer.bytesused = static_cast<std::uint32_t>(picture.size());
    buffer.timestamp = {static_cast<time_t>(exposure_ns / kSecond),
                        static_cast<suseconds_t>(exposure_ns % kSecond / 1000)};
    control(VIDIOC_QBUF, &buffer, "a picture");
    next_ = (next_ + 1) % kBuffers;
  }

 private:
  static constexpr std::uint32_t kBuffers = 2;  // as many as the driver is loaded with

  static v4l2_buffer one(std::uint32_t index) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    return buffer;
  }
  void control(unsigned long request, void* argument, const char* what) const {
    if (ioctl(fd_, request, argument) != 0) die(what);
  }

  int fd_;
  std::uint32_t next_ = 0;
  std::size_t length_ = 0;
  std::array<void*, kBuffers> starts_{};
};

volatile std::sig_atomic_t unplugged = 0;

int show_eyes(const char* port, const char* left_path, const char* right_path) {
  const int fd = open_or_die(port, O_RDONLY);
  kaz::CameraStreamHeader header{};
  read_whole(fd, &header, sizeof header);
  if (std::memcmp(header.magic, kaz::kCameraStreamMagic, sizeof header.magic) != 0)
    die("what comes is no stream of a camera");
  std::signal(SIGUSR1, [](int) { unplugged = unplugged != 0 ? 0 : 1; });
  std::optional<Output> left, right;
  std::vector<std::uint8_t> left_picture(kaz::camera_picture_bytes(header.width, header.height)),
      right_picture(left_picture.size());
  while (true) {
    kaz::CameraStreamPair pair{};
    read_whole(fd, &pair, sizeof pair);
    if (std::memcmp(pair.magic, kaz::kCameraPairMagic, sizeof pair.magic) != 0)
      die("the stream of the camera lost its place");
    read_whole(fd, left_picture.data(), left_picture.size());
    read_whole(fd, right_picture.data(), right_picture.size());
    sleep_until(pair.exposure_ns + header.latency_ns);
    if (unplugged != 0) {
      left.reset();
      right.reset();
      continue;
    }
    if (!left) {
      left.emplace(left_path, header.width, header.height);
      right.emplace(right_path, header.width, header.height);
    }
    left->show(left_picture, pair.exposure_ns);
    right->show(right_picture, pair.exposure_ns);
  }
}

// A line discipline of the kernel makes a CAN interface out of a serial line with an adapter's text on it
// (slcan): one at each end of a pair of joined pseudo-terminals, can0 and can1 where no others are.
int join_slcan() {
  std::array<pollfd, 2> masters{};
  std::array<int, 2> slaves{};
  for (std::size_t i = 0; i < 2; ++i) {
    masters.at(i) = {posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC), POLLIN, 0};
    const int master = masters.at(i).fd;
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) die("no pseudo-terminal");
    slaves.at(i) = open_or_die(ptsname(master), O_RDWR | O_NOCTTY);
    termios settings{};
    tcgetattr(slaves.at(i), &settings);
    cfmakeraw(&settings);
    tcsetattr(slaves.at(i), TCSANOW, &settings);
    const int discipline = N_SLCAN;
    if (ioctl(slaves.at(i), TIOCSETD, &discipline) != 0) die("no slcan");
  }
  while (poll(masters.data(), masters.size(), -1) > 0) {
    for (std::size_t i = 0; i < 2; ++i) {
      std::array<char, 4096> bytes{};
      if ((masters.at(i).revents & POLLIN) == 0) continue;
      const ssize_t got = read(masters.at(i).fd, bytes.data(), bytes.size());
      for (ssize_t done = 0; done < got;) {
        const ssize_t put =
            write(masters.at(1 - i).fd, bytes.data() + done, static_cast<std::size_t>(got - done));
        if (put <= 0) die("a pseudo-terminal takes nothing");
        done += put;
      }
    }
  }
  return 1;
}

}  // namespace

int main(int count, char** arguments) {
  const std::string what = count > 1 ? arguments[1] : "";
  if (what == "clock" && count == 3 && std::atoi(arguments[2]) > 0)
    return send_clock(static_cast<unsigned short>(std::atoi(arguments[2])));
  if (what == "eyes" && count == 5) return show_eyes(arguments[2], arguments[3], arguments[4]);
  if (what == "slcan" && count == 2) return join_slcan();
  std::fprintf(stderr, "usage: feed clock N | feed eyes PORT LEFT RIGHT | feed slcan\n");
  return 2;
}
