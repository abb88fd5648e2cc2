// The whole server with a host of its own on pty and sockets. Runs unpaced.
// SPDX-License-Identifier: Apache-2.0
//
// Server, kernel and host take turns as the machine wants: what a test waits for is a line of the server, a
// reply to a certain request, or simulated time, never a while of the wall clock.
#include "sim/runtime/serving/real_time.h"
#include "shared/base/json_testing.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <termios.h>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <thread>

#include <nlohmann/json.hpp>

#include "shared/base/descriptor.hpp"
#include "sim/mcu/host_testing.h"
#include "sim/runtime/serving/socket_testing.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

// The server in a thread, and what it said.
class Running {
 public:
  explicit Running(const TestFolder& folder) : port(folder.file("port")) {
    RealTimeOptions options;
    options.serial_path = port;
    options.cameras_path = folder.file("cameras");
    options.fast = true;
    options.report = [this](const std::string& line) {
      const std::lock_guard lock(mutex_);
      lines_.push_back(line);
      said_.notify_all();
    };
    auto server = RealTimeServer::open(*simulation_, options);
    EXPECT_TRUE(server) << server.error().message;
    server_ = std::move(*server);
    thread_ = std::thread([this] { EXPECT_TRUE(server_->run(stop_)); });
  }
  ~Running() {
    stop_ = true;
    thread_.join();
  }

  // Waits until a line that contains `text` was said.
  void wait_for(const std::string& text) {
    std::unique_lock lock(mutex_);
    said_.wait(lock, [&] {
      return std::ranges::any_of(
          lines_, [&](const std::string& line) { return line.find(text) != std::string::npos; });
    });
  }

  // Waits until that much simulated time has passed.
  void pass(double simulated_s) const {
    const double until = time_s() + simulated_s;
    while (time_s() < until) std::this_thread::yield();
  }

  nlohmann::ordered_json answer(const std::string& request) const {
    const Descriptor control = connect_to(port + ".ctl");
    std::string line;
    char letter = 0;
    if (::send(control.get(), (request + "\n").data(), request.size() + 1, MSG_NOSIGNAL) < 0)
      throw std::runtime_error("send");
    for (; letter != '\n'; line += letter)
      if (::recv(control.get(), &letter, 1, 0) != 1) throw std::runtime_error("recv");
    return parse_json(line);
  }

  std::string port;

 private:
  double time_s() const { return answer("status")["time_s"].get<double>(); }

  std::unique_ptr<Simulation> simulation_ = test_simulation();
  std::unique_ptr<RealTimeServer> server_;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::condition_variable said_;
  std::vector<std::string> lines_;
  std::thread thread_;
};

void write_all(int fd, const std::vector<std::uint8_t>& bytes) {
  ASSERT_EQ(::write(fd, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
}

// The next valid frame's body.
std::vector<std::uint8_t> read_frame(int fd) {
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  while (true) {
    pollfd readable{fd, POLLIN, 0};
    std::uint8_t byte = 0;
    if (::poll(&readable, 1, 10000) <= 0 || ::read(fd, &byte, 1) != 1) return {};
    if (kz_receive(&receiver, byte, 0) == KZ_RECEIVE_FRAME)
      return {receiver.body, receiver.body + receiver.length};
  }
}

// The board's answer to `identify`; it may still be starting: as a client does, query again. The answer to
// the last query: then none is under way any more.
std::vector<std::uint8_t> identify(int host) {
  for (std::uint8_t n = 1; n < 100; ++n) {
    write_all(host, frame_of(KZ_TYPE_identify, n, {}));
    pollfd readable{host, POLLIN, 0};
    while (::poll(&readable, 1, 100) > 0) {
      const auto reply = read_frame(host);
      if (reply.size() < 3 || reply[2] == n) return reply;
    }
  }
  return {};
}

TEST(RealTimeServer, HostTalksThroughThePty) {
  const TestFolder folder;
  Running server(folder);
  const Descriptor host(::open(server.port.c_str(), O_RDWR | O_NOCTTY));
  ASSERT_TRUE(host);
  server.wait_for("host opened");
  const auto reply = identify(host.get());
  ASSERT_GT(reply.size(), 3u);
  EXPECT_EQ(reply[1], KZ_TYPE_identify_reply);
}

// Of a world without a trunk and without contacts.
TEST(RealTimeServer, StatusHasTouchesOnRequest) {
  const TestFolder folder;
  const Running server(folder);
  auto status = server.answer("status");
  EXPECT_TRUE(status["trunk"].is_null());
  EXPECT_FALSE(status.contains("touched"));
  EXPECT_TRUE(server.answer("touches")["ok"]);
  EXPECT_EQ(server.answer("status")["touched"], nlohmann::ordered_json::array());
}

// What docs/reference/protocol.md and simulator.md state: a pty's rate counts as that of a wire.
TEST(RealTimeServer, ThePortsRateCountsAsOnAWire) {
  const TestFolder folder;
  Running server(folder);
  const Descriptor host(::open(server.port.c_str(), O_RDWR | O_NOCTTY));
  ASSERT_TRUE(host);
  server.wait_for("host opened");
  ASSERT_FALSE(identify(host.get()).empty());
  const auto at = [&](speed_t rate) {
    termios settings{};
    ASSERT_EQ(tcgetattr(host.get(), &settings), 0);
    cfsetspeed(&settings, rate);
    ASSERT_EQ(tcsetattr(host.get(), TCSAFLUSH, &settings), 0);
  };
  at(B57600);
  server.wait_for("to 57600 baud");
  for (std::uint8_t n = 100; n < 105; ++n) {
    write_all(host.get(), frame_of(KZ_TYPE_identify, n, {}));
    server.pass(0.05);
    pollfd readable{host.get(), POLLIN, 0};
    EXPECT_EQ(::poll(&readable, 1, 0), 0) << "a damaged frame has no reply";
  }
  at(B115200);
  EXPECT_FALSE(identify(host.get()).empty());
}

// As with an adapter that is pulled: who has the port open finds it gone, and the board goes on.
TEST(RealTimeServer, ThePlugCanBePulledAndPutBack) {
  const TestFolder folder;
  Running server(folder);
  const Descriptor host(::open(server.port.c_str(), O_RDWR | O_NOCTTY));
  ASSERT_TRUE(host);
  server.wait_for("host opened");
  ASSERT_FALSE(identify(host.get()).empty());
  const Descriptor control = connect_to(server.port + ".ctl");
  ASSERT_EQ(::send(control.get(), "plug out\n", 9, MSG_NOSIGNAL), 9);
  server.wait_for("is unplugged");
  pollfd hung_up{host.get(), POLLIN, 0};
  EXPECT_EQ(::poll(&hung_up, 1, 10000), 1);
  EXPECT_NE(hung_up.revents & POLLHUP, 0);
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(server.port)));
  server.wait_for("host closed");
  ASSERT_EQ(::send(control.get(), "plug in\n", 8, MSG_NOSIGNAL), 8);
  server.wait_for("is plugged in");
  const Descriptor again(::open(server.port.c_str(), O_RDWR | O_NOCTTY));
  ASSERT_TRUE(again);
  EXPECT_FALSE(identify(again.get()).empty());
}

TEST(RealTimeServer, KilledHostLeavesMotorsOff) {
  const TestFolder folder;
  Running server(folder);
  // Again and again, as new requests: the first ones may find a board that has not measured its supply
  // yet, and a repetition of what was refused is refused again.
  std::vector<std::uint8_t> frames;
  for (std::uint8_t n = 1; n <= 2 * KZ_REQUESTS_REMEMBERED; ++n) {
    const auto frame = enable_frame(n, 1);
    frames.insert(frames.end(), frame.begin(), frame.end());
  }
  const pid_t host = ::fork();
  ASSERT_GE(host, 0);
  if (host == 0) {
    const int fd = ::open(server.port.c_str(), O_RDWR | O_NOCTTY);
    while (fd >= 0 && ::write(fd, frames.data(), frames.size()) >= 0) continue;
    ::_exit(1);
  }
  server.wait_for("motors on");
  ::kill(host, SIGKILL);
  ::waitpid(host, nullptr, 0);
  server.wait_for("host closed");
  server.wait_for("s: shutdown, no request came for too long, ");
}

TEST(RealTimeServer, LeavesNothingBehind) {
  const TestFolder folder;
  { Running server(folder); }
  EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(folder.file("x")).parent_path()));
}

TEST(RealTimeServer, SecondServerOfTheSamePathsIsRefused) {
  const TestFolder folder;
  Running server(folder);
  const auto link = std::filesystem::read_symlink(server.port);
  auto simulation = test_simulation();
  RealTimeOptions options;
  options.serial_path = server.port;
  const auto second = RealTimeServer::open(*simulation, options);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().fault, Fault::environment);
  EXPECT_EQ(std::filesystem::read_symlink(server.port), link);
}

}  // namespace
}  // namespace kaz::sim
