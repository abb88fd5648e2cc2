// PublishedCamera on real sockets, and Capture on top.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/published_camera.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "host/link/wall_clock.h"
#include "shared/base/camera_stream.hpp"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

// Listens on a socket of its own. The backlog accepts the client before accept() is called.
class Publisher {
 public:
  Publisher() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("kaz-camera-test-" + std::to_string(getpid()) + "-" + std::to_string(count++));
    std::filesystem::remove(path_);
    listener_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    if (bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
        listen(listener_, 1) != 0) {
      throw std::runtime_error("cannot listen at " + path_);
    }
  }
  ~Publisher() {
    stop();
    std::filesystem::remove(path_);
  }
  void accept_client() { client_ = accept(listener_, nullptr, nullptr); }
  void send(const void* bytes, std::size_t size) {
    ASSERT_EQ(::send(client_, bytes, size, MSG_NOSIGNAL), static_cast<ssize_t>(size));
  }
  void stop() {
    if (client_ >= 0) close(client_);
    if (listener_ >= 0) close(listener_);
    client_ = listener_ = -1;
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int listener_ = -1, client_ = -1;
};

CameraStreamHeader header(Time latency = 0ms) {
  CameraStreamHeader h{};
  std::memcpy(h.magic, kCameraStreamMagic, sizeof h.magic);
  h.version = kCameraStreamVersion;
  h.width = 8;
  h.height = 6;
  h.fx = h.fy = 10;
  h.cx = 3.5;
  h.cy = 2.5;
  h.baseline_m = 0.04;
  h.latency_ns = latency.count();
  return h;
}

void send_pair(Publisher& publisher, std::uint64_t sequence, Time exposure, char left, char right) {
  CameraStreamPair pair{};
  std::memcpy(pair.magic, kCameraPairMagic, sizeof pair.magic);
  pair.sequence = sequence;
  pair.exposure_ns = exposure.count();
  publisher.send(&pair, sizeof pair);
  publisher.send(std::string(8 * 6 * 3, left).data(), 8 * 6 * 3);
  publisher.send(std::string(8 * 6 * 3, right).data(), 8 * 6 * 3);
}

// A connected pair of both ends. The header lies in the socket before the client looks.
std::unique_ptr<PublishedCamera> connected(Publisher& publisher, const CameraStreamHeader& with,
                                           Time silence = PublishedCamera::kSilence) {
  std::thread server([&] {
    publisher.accept_client();
    publisher.send(&with, sizeof with);
  });
  auto camera = PublishedCamera::connect(publisher.path(), 2s, silence);
  server.join();
  if (!camera) throw std::runtime_error(camera.error().message);
  return std::move(*camera);
}

Result<std::optional<vision::StereoPair>> wait_for_pair(PublishedCamera& camera) {
  const WallClock clock;
  const Time deadline = clock.now() + 5s;
  while (clock.now() < deadline) {
    auto pair = camera.poll();
    if (!pair || *pair) return pair;
    std::this_thread::sleep_for(1ms);
  }
  return std::nullopt;
}

TEST(PublishedCamera, ReceivesPairsInOrder) {
  Publisher publisher;
  auto camera = connected(publisher, header());
  EXPECT_EQ(camera->model().width, 8);
  EXPECT_EQ(camera->model().height, 6);
  EXPECT_DOUBLE_EQ(camera->model().cx, 3.5);
  EXPECT_DOUBLE_EQ(camera->model().baseline_m, 0.04);
  for (const std::uint64_t n : {7u, 8u}) {
    send_pair(publisher, n, Time(1000 + n), 'l', 'r');
    const auto pair = wait_for_pair(*camera);
    ASSERT_TRUE(pair && *pair);
    EXPECT_EQ((*pair)->info.sequence, n);
    EXPECT_EQ((*pair)->info.exposure, Time(1000 + n));
    EXPECT_FALSE((*pair)->info.posture_known);
    const auto images = (*pair)->images.get();
    EXPECT_EQ(images->left.rgb, std::vector<std::uint8_t>(8 * 6 * 3, 'l'));
    EXPECT_EQ(images->right.rgb, std::vector<std::uint8_t>(8 * 6 * 3, 'r'));
  }
}

TEST(PublishedCamera, KeepsTheDeclaredLatency) {
  Publisher publisher;
  auto camera = connected(publisher, header(60ms));
  const Time exposure = WallClock().now();
  send_pair(publisher, 0, exposure, 'l', 'r');
  const auto pair = wait_for_pair(*camera);
  ASSERT_TRUE(pair && *pair);
  EXPECT_GE(WallClock().now() - exposure, 60ms);
  EXPECT_EQ(camera->latency(), 60ms);
}

TEST(PublishedCamera, GivesWhatCameAndThenSaysThatItStopped) {
  Publisher publisher;
  auto camera = connected(publisher, header());
  send_pair(publisher, 3, 0ms, 'a', 'b');
  publisher.stop();
  const auto pair = wait_for_pair(*camera);
  ASSERT_TRUE(pair && *pair);
  const auto end = wait_for_pair(*camera);
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().fault, Fault::environment);
  EXPECT_EQ(end.error().message,
            "camera " + publisher.path() + " stopped: the simulator ended or was killed");
}

TEST(PublishedCamera, StopsInTheMiddleOfAPicture) {
  Publisher publisher;
  auto camera = connected(publisher, header());
  CameraStreamPair pair{};
  std::memcpy(pair.magic, kCameraPairMagic, sizeof pair.magic);
  publisher.send(&pair, sizeof pair);
  publisher.send("half", 4);
  publisher.stop();
  EXPECT_FALSE(wait_for_pair(*camera));
}

// What a publisher sends that is paused, before it is silent: nothing, a pair, or a part of one.
TEST(PublishedCamera, SaysThatNothingComes) {
  CameraStreamPair head{};
  std::memcpy(head.magic, kCameraPairMagic, sizeof head.magic);
  for (const auto& [parts, missing] : {std::pair{-1, "the next pair"},
                                       {0, "the next pair"},
                                       {1, "the left picture"},
                                       {2, "the right picture"},
                                       {3, "the right picture"}}) {
    Publisher publisher;
    auto camera = connected(publisher, header(), 1s);
    if (parts >= 0) {
      send_pair(publisher, 0, Time(0), 'l', 'r');
      const auto pair = wait_for_pair(*camera);
      ASSERT_TRUE(pair && *pair);
    }
    const std::string picture(8 * 6 * 3, 'x');
    if (parts >= 1) publisher.send(&head, sizeof head);
    if (parts >= 2) publisher.send(picture.data(), picture.size());
    if (parts >= 3) publisher.send(picture.data(), picture.size() / 2);
    const auto end = wait_for_pair(*camera);
    ASSERT_FALSE(end) << missing;
    EXPECT_EQ(end.error().fault, Fault::environment);
    EXPECT_EQ(end.error().message,
              "camera " + publisher.path() + " stopped: no complete pair came for 1 s, because " +
                  missing + " is missing; check whether the publisher is paused");
  }
}

TEST(PublishedCamera, NoticesGarbageBetweenPairs) {
  Publisher publisher;
  auto camera = connected(publisher, header());
  publisher.send(std::string(100, 'x').data(), 100);
  const auto end = wait_for_pair(*camera);
  ASSERT_FALSE(end);
  EXPECT_NE(end.error().message.find("is not a stereo pair"), std::string::npos);
}

TEST(PublishedCamera, DropsOldPairsOfASlowUser) {
  Publisher publisher;
  auto camera = connected(publisher, header());
  for (std::uint64_t n = 0; n < 20; ++n) send_pair(publisher, n, Time(n), 'l', 'r');
  publisher.stop();
  std::this_thread::sleep_for(100ms);
  std::vector<std::uint64_t> numbers;
  while (auto pair = wait_for_pair(*camera)) numbers.push_back((*pair)->info.sequence);
  ASSERT_FALSE(numbers.empty());
  EXPECT_LE(numbers.size(), PublishedCamera::kMostWaiting);
  EXPECT_EQ(numbers.back(), 19u);
}

std::string error_at(const std::string& path, Time patience = 100ms) {
  const auto camera = PublishedCamera::connect(path, patience);
  if (camera) return "connected";
  EXPECT_EQ(camera.error().fault, Fault::environment);
  return camera.error().message;
}

std::string error_from(const CameraStreamHeader& with,
                       std::size_t bytes = sizeof(CameraStreamHeader), bool then_close = false) {
  Publisher publisher;
  std::thread server([&] {
    publisher.accept_client();
    publisher.send(&with, bytes);
    if (then_close) publisher.stop();
  });
  const std::string message = error_at(publisher.path());
  server.join();
  return message;
}

TEST(PublishedCamera, SaysWhyThereIsNone) {
  EXPECT_NE(error_at("/nowhere/at/all").find("no program publishes a camera there"),
            std::string::npos);
  EXPECT_NE(error_at(std::string(200, 'x')).find("at most 107 characters"), std::string::npos);

  const auto file =
      std::filesystem::temp_directory_path() / ("kaz-no-camera-" + std::to_string(getpid()));
  std::ofstream(file) << "text";
  EXPECT_NE(error_at(file).find("it is a file"), std::string::npos);
  std::filesystem::remove(file);

  Publisher ended;
  ended.stop();
  EXPECT_NE(error_at(ended.path()).find("its simulator has ended"), std::string::npos);
}

TEST(PublishedCamera, SaysWhatIsWrongWithTheStream) {
  CameraStreamHeader other = header();
  std::memcpy(other.magic, "HTTP", 4);
  EXPECT_NE(error_from(other).find("starts with 48 54 54 50"), std::string::npos);
  other = header();
  other.version = 9;
  EXPECT_NE(error_from(other).find("has version 9"), std::string::npos);
  other = header();
  other.width = 100000;
  EXPECT_NE(error_from(other).find("100000 x 6"), std::string::npos);
  EXPECT_NE(error_from(header(), 10).find("no complete header within 100 ms"), std::string::npos);
  EXPECT_NE(error_from(header(), 10, true).find("closed the connection"), std::string::npos);
}

// Numbers that no camera has: none, infinite, or so large that sums with them are.
TEST(PublishedCamera, RefusesImpossibleNumbers) {
  using Header = CameraStreamHeader;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (double Header::*const field :
       {&Header::fx, &Header::fy, &Header::cx, &Header::cy, &Header::baseline_m}) {
    for (const double number : {std::nan(""), kInfinity, -kInfinity, 1e300, -1e300}) {
      Header h = header();
      h.*field = number;
      const auto stream = parse(h, "eyes");
      ASSERT_FALSE(stream) << number;
      EXPECT_NE(stream.error().message.find("eyes declares an impossible camera"),
                std::string::npos)
          << stream.error().message;
    }
  }
  for (const std::int64_t latency_ns :
       {std::int64_t{-1}, std::int64_t{10'000'000'001}, std::numeric_limits<std::int64_t>::max(),
        std::numeric_limits<std::int64_t>::min()}) {
    Header h = header();
    h.latency_ns = latency_ns;
    EXPECT_FALSE(parse(h, "eyes")) << latency_ns;
  }
  Header h = header();
  h.height = 0;
  EXPECT_FALSE(parse(h, "eyes"));
  h.height = 0x8000'0006;
  EXPECT_FALSE(parse(h, "eyes"));
  EXPECT_TRUE(parse(header(10s), "eyes"));
}

// Time of exposure and latency both come over the wire: their sum must not overflow, and a pair that is
// never due must not keep back the others in silence.
TEST(PublishedCamera, RefusesTimesOfAnotherClock) {
  for (const Time exposure : {Time::max(), Time::min(), Time(-1), WallClock().now() + 1h}) {
    Publisher publisher;
    const auto camera = connected(publisher, header(10s));
    send_pair(publisher, 0, exposure, 'l', 'r');
    const auto pair = wait_for_pair(*camera);
    ASSERT_FALSE(pair) << exposure.count();
    EXPECT_NE(pair.error().message.find(publisher.path()), std::string::npos);
    EXPECT_NE(pair.error().message.find("not a valid time on this machine's clock"),
              std::string::npos)
        << pair.error().message;
  }
}

}  // namespace
}  // namespace kaz::host
