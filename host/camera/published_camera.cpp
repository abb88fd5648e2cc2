// A thread reads pairs from the socket; poll() returns them when their latency has passed.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/published_camera.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <span>

#include "host/link/wall_clock.h"

namespace kaz::host {

namespace {

class Socket {
 public:
  explicit Socket(int fd) : fd_(fd) {}
  ~Socket() {
    if (fd_ >= 0) close(fd_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int get() const { return fd_; }
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

enum class Received { all, ended, late };

// Reads until `to` is full, the stream ends, or the time is up.
Received read_fully(int socket, std::span<std::uint8_t> to, Time deadline) {
  while (!to.empty()) {
    pollfd watched{socket, POLLIN, 0};
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - WallClock().now()).count();
    const int ready = ::poll(&watched, 1, static_cast<int>(std::max<std::int64_t>(left, 0)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return Received::late;
    const ssize_t n = ready < 0 ? -1 : recv(socket, to.data(), to.size(), 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return Received::ended;
    to = to.subspan(static_cast<std::size_t>(n));
  }
  return Received::all;
}

Result<int> connect_socket(const std::string& path) {
  const auto refuse = [&](const std::string& why) {
    return fail(Fault::environment, "no camera at " + path + ": " + why);
  };
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    return refuse("the path of a socket may have at most " +
                  std::to_string(sizeof address.sun_path - 1) + " characters");
  }
  std::copy(path.begin(), path.end(), address.sun_path);

  Socket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (socket.get() < 0) return refuse(std::strerror(errno));
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    struct stat info {};
    switch (errno) {
      case ENOENT:
      case ENOTDIR:
        return refuse("no program publishes a camera there; start `kaz sim` with `--cameras " +
                      path + "` first");
      case ECONNREFUSED:
        if (stat(path.c_str(), &info) == 0 && !S_ISSOCK(info.st_mode)) {
          return refuse("it is a file, not a socket made by `kaz sim --cameras`");
        }
        return refuse("its simulator has ended; start it again");
      case EACCES:
        return refuse("permission denied; run as the user who runs the simulator");
      default:
        return refuse(std::strerror(errno));
    }
  }
  return socket.release();
}

Result<CameraStreamHeader> read_header(const std::string& path, int socket, Time patience) {
  CameraStreamHeader header{};
  const WallClock clock;
  const Time deadline = clock.now() + patience;
  std::size_t done = 0;
  while (done < sizeof header) {
    pollfd watched{socket, POLLIN, 0};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - clock.now());
    const int ready = poll(&watched, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) {
      return fail(Fault::environment, "the program at " + path +
                                          " sends no camera stream: no complete header within " +
                                          std::to_string(patience.count() / 1'000'000) + " ms");
    }
    const ssize_t n =
        recv(socket, reinterpret_cast<char*>(&header) + done, sizeof header - done, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      return fail(Fault::environment, "the program at " + path +
                                          " closed the connection before it sent a camera stream");
    }
    done += static_cast<std::size_t>(n);
  }
  return header;
}

}  // namespace

Result<std::unique_ptr<PublishedCamera>> PublishedCamera::connect(const std::string& path,
                                                                  Time patience, Time silence) {
  const auto fd = KAZ_TRY(connect_socket(path));
  Socket socket(fd);
  const auto header = KAZ_TRY(read_header(path, socket.get(), patience));
  const auto stream = KAZ_TRY(parse(header, path));
  return std::unique_ptr<PublishedCamera>(
      new PublishedCamera(path, socket.release(), stream, silence));
}

PublishedCamera::PublishedCamera(std::string path, int socket, const CameraStream& stream,
                                 Time silence)
    : path_(std::move(path)), socket_(socket), stream_(stream), silence_(silence), reader_([this] {
        read_pairs();
      }) {}

PublishedCamera::~PublishedCamera() {
  shutdown(socket_, SHUT_RDWR);  // wakes the reader
  reader_.join();
  close(socket_);
}

void PublishedCamera::stop(Error error) {
  const std::lock_guard lock(mutex_);
  stopped_ = std::move(error);
}

bool PublishedCamera::read(std::span<std::uint8_t> to, const char* part, Time deadline) {
  const Received received = read_fully(socket_, to, deadline);
  if (received == Received::all) return true;
  if (received == Received::ended) {
    stop({Fault::environment, "camera " + path_ + " stopped: the simulator ended or was killed"});
    return false;
  }
  char text[160];
  std::snprintf(
      text, sizeof text,
      " stopped: no complete pair came for %.3g s, because %s is missing; check whether the "
      "publisher is paused",
      seconds(silence_), part);
  stop({Fault::environment, "camera " + path_ + text});
  return false;
}

void PublishedCamera::read_pairs() {
  const vision::CameraModel& model = stream_.model;
  const std::size_t size = camera_picture_bytes(static_cast<std::uint32_t>(model.width),
                                                static_cast<std::uint32_t>(model.height));
  while (true) {
    const Time deadline = WallClock().now() + silence_;
    CameraStreamPair header{};
    if (!read({reinterpret_cast<std::uint8_t*>(&header), sizeof header}, "the next pair", deadline))
      return;
    auto info = parse(header, stream_, WallClock().now(), path_);
    if (!info) return stop(info.error());
    auto images = std::make_shared<vision::StereoImages>();
    for (vision::Image* image : {&images->left, &images->right}) {
      image->width = model.width;
      image->height = model.height;
      image->rgb.resize(size);
      const bool left = image == &images->left;
      if (!read(image->rgb, left ? "the left picture" : "the right picture", deadline)) return;
    }

    vision::StereoPair pair;
    pair.info = std::move(*info);
    std::promise<std::shared_ptr<const vision::StereoImages>> ready;
    ready.set_value(std::move(images));
    pair.images = ready.get_future().share();

    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(pair));
    if (waiting_.size() > kMostWaiting) waiting_.pop_front();
  }
}

Result<std::optional<vision::StereoPair>> PublishedCamera::poll() {
  const Time now = WallClock().now();
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) {
    if (stopped_) return tl::unexpected(*stopped_);
    return std::nullopt;
  }
  if (waiting_.front().info.exposure + stream_.latency > now) return std::nullopt;
  vision::StereoPair pair = std::move(waiting_.front());
  waiting_.pop_front();
  return pair;
}

}  // namespace kaz::host
