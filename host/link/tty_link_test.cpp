// TtyLink and WallClock on real pseudo-terminals.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/tty_link.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <thread>

#include "host/link/serial_port.h"
#include "host/link/wall_clock.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

// The end of a line at which a board would be.
class FarEnd {
 public:
  FarEnd() {
    int slave = -1;
    char name[64] = {};
    if (openpty(&master_, &slave, name, nullptr, nullptr) != 0) throw std::runtime_error("openpty");
    path_ = name;
    close(slave);
  }
  ~FarEnd() { hang_up(); }
  void hang_up() {
    if (master_ >= 0) close(master_);
    master_ = -1;
  }
  const std::string& path() const { return path_; }
  void send(std::span<const std::uint8_t> bytes) {
    ASSERT_EQ(::write(master_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  std::vector<std::uint8_t> receive(std::size_t count) {
    std::vector<std::uint8_t> bytes(count);
    std::size_t done = 0;
    while (done < count) {
      const ssize_t n = ::read(master_, bytes.data() + done, count - done);
      if (n <= 0) break;
      done += static_cast<std::size_t>(n);
    }
    bytes.resize(done);
    return bytes;
  }

 private:
  int master_ = -1;
  std::string path_;
};

std::vector<std::uint8_t> all_bytes() {
  std::vector<std::uint8_t> bytes(256);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
  return bytes;
}

TEST(TtyLink, CarriesEveryByteValueBothWays) {
  FarEnd board;
  auto link = TtyLink::open(board.path());
  ASSERT_TRUE(link) << link.error().message;
  const auto bytes = all_bytes();
  ASSERT_TRUE((*link)->write(bytes));
  EXPECT_EQ(board.receive(256), bytes);

  board.send(bytes);
  std::vector<std::uint8_t> received;
  while (received.size() < 256) {
    std::array<std::uint8_t, 100> buffer;
    const auto count = (*link)->read(buffer, WallClock().now() + 1s);
    ASSERT_TRUE(count);
    ASSERT_GT(*count, 0u);
    received.insert(received.end(), buffer.begin(), buffer.begin() + static_cast<long>(*count));
  }
  EXPECT_EQ(received, bytes);
  EXPECT_EQ((*link)->byte_time(), 86805ns);  // 10 bits at 115,200 a second
}

TEST(TtyLink, WaitsUntilTheDeadline) {
  FarEnd board;
  auto link = TtyLink::open(board.path());
  ASSERT_TRUE(link);
  std::uint8_t buffer[8];
  const Time before = WallClock().now();
  const auto count = (*link)->read(buffer, before + 30ms);
  ASSERT_TRUE(count);
  EXPECT_EQ(*count, 0u);
  EXPECT_GE(WallClock().now() - before, 30ms);
}

// More than the terminal's buffer: the rest leaves while the link reads.
TEST(TtyLink, KeepsWhatThePortDoesNotTakeAtOnce) {
  FarEnd board;
  auto link = TtyLink::open(board.path());
  ASSERT_TRUE(link);
  std::vector<std::uint8_t> sent;
  while (sent.size() < 20000) {
    for (const std::uint8_t byte : all_bytes()) sent.push_back(byte);
  }
  ASSERT_TRUE((*link)->write(sent));
  std::vector<std::uint8_t> received;
  std::thread reader([&] { received = board.receive(sent.size()); });
  std::uint8_t buffer[8];
  for (int i = 0; i < 50; ++i) ASSERT_TRUE((*link)->read(buffer, WallClock().now() + 5ms));
  board.send(std::array<std::uint8_t, 1>{1});
  reader.join();
  EXPECT_EQ(received, sent);

  const std::vector<std::uint8_t> flood(70000);
  const auto refused = (*link)->write(flood);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("does not accept bytes"), std::string::npos);
}

TEST(TtyLink, ReportsWhenItIsDrainedAndDiscardsWhatIsNamed) {
  FarEnd board;
  auto link = TtyLink::open(board.path());
  ASSERT_TRUE(link);
  EXPECT_TRUE((*link)->drained());
  ASSERT_TRUE((*link)->write(std::vector<std::uint8_t>(20000, 1)));  // more than the terminal holds
  EXPECT_FALSE((*link)->drained());
  board.send(std::array<std::uint8_t, 2>{7, 8});
  std::this_thread::sleep_for(20ms);
  (*link)->purge(false, true);
  EXPECT_TRUE((*link)->drained());
  std::uint8_t buffer[8];
  const auto kept = (*link)->read(buffer, WallClock().now() + 5s);
  ASSERT_TRUE(kept);
  EXPECT_EQ(*kept, 2u) << "what was received stays";
  board.send(std::array<std::uint8_t, 2>{7, 8});
  std::this_thread::sleep_for(20ms);
  (*link)->purge(true, false);
  EXPECT_EQ((*link)->read(buffer, WallClock().now() + 20ms).value(), 0u);
}

TEST(TtyLink, SaysThatThePortWasClosed) {
  FarEnd board;
  auto link = TtyLink::open(board.path());
  ASSERT_TRUE(link);
  std::thread unplug([&] {
    std::this_thread::sleep_for(20ms);
    board.hang_up();
  });
  std::uint8_t buffer[8];
  const Time before = WallClock().now();
  const auto count = (*link)->read(buffer, before + 10s);
  unplug.join();
  ASSERT_FALSE(count);
  EXPECT_LT(WallClock().now() - before, 5s);
  EXPECT_EQ(count.error().fault, Fault::environment);
  EXPECT_EQ(count.error().message,
            "port " + board.path() + " was closed: the board was unplugged or the simulator ended");
  EXPECT_FALSE((*link)->read(buffer, WallClock().now() + 10s));
  EXPECT_FALSE((*link)->write(buffer));
}

TEST(TtyLink, OpensAgainWhatIsPluggedInAgain) {
  namespace fs = std::filesystem;
  const fs::path path = fs::temp_directory_path() / ("kaz-replug-" + std::to_string(getpid()));
  fs::remove(path);
  auto board = std::make_unique<FarEnd>();
  fs::create_symlink(board->path(), path);
  auto link = TtyLink::open(path);
  ASSERT_TRUE(link) << link.error().message;
  fs::remove(path);
  board->hang_up();
  std::uint8_t buffer[8];
  EXPECT_FALSE((*link)->read(buffer, WallClock().now() + 1s));
  const auto gone = (*link)->reopen();
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().fault, Fault::environment);
  EXPECT_FALSE((*link)->read(buffer, WallClock().now() + 1s));
  EXPECT_FALSE((*link)->write(buffer));

  board = std::make_unique<FarEnd>();
  fs::create_symlink(board->path(), path);
  ASSERT_TRUE((*link)->reopen());
  const auto bytes = all_bytes();
  ASSERT_TRUE((*link)->write(bytes));
  EXPECT_EQ(board->receive(256), bytes);
  EXPECT_EQ((*link)->low_latency(), LowLatency::pseudo_terminal);
  fs::remove(path);
}

TEST(TtyLink, IsInterruptedFromAnotherThread) {
  FarEnd board;
  Interrupt interrupt;
  auto link = TtyLink::open(board.path(), 115200, &interrupt);
  ASSERT_TRUE(link);
  WallClock clock(&interrupt);
  ASSERT_TRUE(clock.sleep_until(clock.now() + 1ms));
  std::thread signal([&] {
    std::this_thread::sleep_for(20ms);
    interrupt.request();
  });
  std::uint8_t buffer[8];
  const Time before = clock.now();
  const auto count = (*link)->read(buffer, before + 10s);
  signal.join();
  ASSERT_FALSE(count);
  EXPECT_EQ(count.error().fault, Fault::interrupted);
  EXPECT_NE(count.error().message.find("interrupted"), std::string::npos);
  EXPECT_FALSE(clock.sleep_until(clock.now() + 10s));
  EXPECT_LT(clock.now() - before, 5s);

  // Motors can still be switched off.
  ASSERT_TRUE((*link)->write(all_bytes()));
  EXPECT_EQ(board.receive(256).size(), 256u);
}

TEST(TtyLink, LetsACleanUpTalkAfterAnInterrupt) {
  FarEnd board;
  Interrupt interrupt;
  auto link = TtyLink::open(board.path(), 115200, &interrupt);
  ASSERT_TRUE(link);
  WallClock clock(&interrupt);
  interrupt.request();
  std::uint8_t buffer[8];
  const auto read = [&](Time at_most) { return (*link)->read(buffer, clock.now() + at_most); };
  ASSERT_FALSE(read(1s));
  {
    const CleanUp clean_up(interrupt, 1h);
    EXPECT_TRUE(clock.sleep_until(clock.now() + 1ms));
    EXPECT_EQ(read(1ms).value_or(1), 0u) << "nothing came";
    board.send(std::vector<std::uint8_t>{7});
    EXPECT_EQ(read(60s).value_or(0), 1u);
  }
  {
    const CleanUp clean_up(interrupt, 20ms);
    // Not longer than it may take.
    const Time before = clock.now();
    EXPECT_FALSE(read(60s));
    EXPECT_LT(clock.now() - before, 5s);
  }
  EXPECT_FALSE(read(1s));
  EXPECT_FALSE(clock.sleep_until(clock.now() + 1s));
}

// Linux gives the number of a killed simulator's pty to the next one: another board, or a terminal.
TEST(TtyLink, RefusesTheLinkOfASimulatorThatWasKilled) {
  namespace fs = std::filesystem;
  const std::string path = fs::temp_directory_path() / ("kaz-killed-" + std::to_string(getpid()));
  const std::string control = path + ".ctl";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  control.copy(address.sun_path, sizeof address.sun_path - 1);
  FarEnd board;
  fs::create_symlink(board.path(), path);
  int fd = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(listen(fd, 1), 0);
  auto link = TtyLink::open(path);
  ASSERT_TRUE(link) << link.error().message;
  ASSERT_TRUE((*link)->reopen());
  for (int i = 0; i < 3; ++i)
    EXPECT_TRUE((*link)->reopen()) << "it has more connections waiting than it takes: it is busy";

  // As the kernel leaves both when the process is killed.
  close(fd);
  FarEnd other;
  fs::remove(path);
  fs::create_symlink(other.path(), path);
  const auto again = (*link)->reopen();
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().fault, Fault::environment);
  EXPECT_NE(again.error().message.find("left behind by a `kaz sim` that was killed"),
            std::string::npos)
      << again.error().message;
  EXPECT_FALSE(TtyLink::open(path));
  EXPECT_TRUE(TtyLink::open(other.path())) << "by its own name it is a port";
  fs::remove(control);
  EXPECT_TRUE((*link)->reopen()) << "a link that somebody else has made";
  fs::remove(path);
}

TEST(TtyLink, OpensThroughASymbolicLinkAndOnlyOnce) {
  FarEnd board;
  const auto path =
      std::filesystem::temp_directory_path() / ("kaz-tty-test-" + std::to_string(getpid()));
  std::filesystem::remove(path);
  std::filesystem::create_symlink(board.path(), path);
  {
    auto link = TtyLink::open(path);
    ASSERT_TRUE(link) << link.error().message;
    const auto second = TtyLink::open(path);
    ASSERT_FALSE(second);
    EXPECT_NE(second.error().message.find("in use by another program"), std::string::npos);
  }
  EXPECT_TRUE(TtyLink::open(path)) << "free again once the first is gone";
  std::filesystem::remove(path);
}

TEST(TtyLink, SaysWhyAPortCannotBeOpened) {
  const auto missing = TtyLink::open("/dev/ttyNoSuchPort");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().fault, Fault::environment);
  EXPECT_EQ(missing.error().message.find("no such port: /dev/ttyNoSuchPort ("), 0u);
  for (const std::string& port : serial_port_candidates()) {
    EXPECT_NE(missing.error().message.find(port), std::string::npos);
  }

  const auto file =
      std::filesystem::temp_directory_path() / ("kaz-no-tty-" + std::to_string(getpid()));
  std::ofstream(file) << "text";
  const auto no_tty = TtyLink::open(file);
  ASSERT_FALSE(no_tty);
  EXPECT_NE(no_tty.error().message.find("is not a serial port"), std::string::npos);
  std::filesystem::remove(file);

  // The control socket of a virtual board, and another one.
  for (const std::string& name : {std::string("board.ctl"), std::string("other")}) {
    const std::string path =
        std::filesystem::temp_directory_path() / ("kaz-" + std::to_string(getpid()) + name);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    ASSERT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    const auto opened = TtyLink::open(path);
    ASSERT_FALSE(opened);
    const std::string& message = opened.error().message;
    EXPECT_NE(message.find("socket"), std::string::npos) << message;
    const std::string its_port = path.substr(0, path.size() - 4);
    EXPECT_EQ(message.ends_with(" " + its_port), name == "board.ctl") << message;
    close(fd);
    std::filesystem::remove(path);
  }

  FarEnd board;
  const auto rate = TtyLink::open(board.path(), 12345);
  ASSERT_FALSE(rate);
  EXPECT_EQ(rate.error().fault, Fault::usage);
  EXPECT_NE(rate.error().message.find("115200"), std::string::npos);
}

}  // namespace
}  // namespace kaz::host
