// A real pseudo-terminal, opened, used, closed and killed by hosts.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/pty.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>

#include <array>
#include <csignal>
#include <fstream>
#include <numeric>
#include <utility>
#include <vector>

#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

Descriptor open_host(const std::string& path) {
  return Descriptor(::open(path.c_str(), O_RDWR | O_NOCTTY));
}

std::unique_ptr<Pty> opened(const std::string& link) {
  auto pty = Pty::open(link);
  EXPECT_TRUE(pty) << pty.error().message;
  return pty ? std::move(*pty) : nullptr;
}

// What a host has written, once the kernel has carried it over.
Bytes receive(Pty& pty, std::size_t count) {
  Bytes bytes(count);
  for (std::size_t done = 0; done < count;) done += pty.read(std::span(bytes).subspan(done));
  return bytes;
}

TEST(Pty, KnowsWhenTheHostComesAndGoes) {
  const TestFolder folder;
  const auto pty = opened(folder.file("port"));
  EXPECT_FALSE(pty->host_present());
  for (int i = 0; i < 3; ++i) {
    {
      const Descriptor host = open_host(pty->link());
      ASSERT_TRUE(host);
      EXPECT_TRUE(pty->host_present());
    }
    EXPECT_FALSE(pty->host_present());
  }
}

TEST(Pty, CarriesAllBytesBothWays) {
  const TestFolder folder;
  const auto pty = opened(folder.file("port"));
  const Descriptor host = open_host(pty->link());
  Bytes all(256);
  std::iota(all.begin(), all.end(), std::uint8_t{0});
  ASSERT_EQ(::write(host.get(), all.data(), all.size()), 256);
  EXPECT_EQ(receive(*pty, 256), all);

  EXPECT_EQ(pty->write(all), 256u);
  Bytes heard(256);
  std::size_t count = 0;
  while (count < heard.size()) {
    pollfd readable{host.get(), POLLIN, 0};
    ASSERT_GT(::poll(&readable, 1, 10000), 0) << count;
    const ssize_t got = ::read(host.get(), heard.data() + count, heard.size() - count);
    ASSERT_GT(got, 0);
    count += static_cast<std::size_t>(got);
  }
  EXPECT_EQ(heard, all);
  Bytes echo(8);
  EXPECT_EQ(pty->read(echo), 0u);
}

TEST(Pty, SpeedIsTheHostsAndStartsRight) {
  const TestFolder folder;
  const auto pty = opened(folder.file("port"));
  EXPECT_EQ(pty->baud(), 115200);
  const Descriptor host = open_host(pty->link());
  termios settings{};
  ASSERT_EQ(tcgetattr(host.get(), &settings), 0);
  EXPECT_EQ(settings.c_lflag & (ECHO | ICANON | ISIG), 0u);
  cfsetspeed(&settings, B9600);
  ASSERT_EQ(tcsetattr(host.get(), TCSANOW, &settings), 0);
  EXPECT_EQ(pty->baud(), 9600);
  for (const auto& [baud, code] : {std::pair{500000, B500000}, std::pair{576000, B576000}}) {
    cfsetspeed(&settings, code);
    ASSERT_EQ(tcsetattr(host.get(), TCSANOW, &settings), 0);
    EXPECT_EQ(pty->baud(), baud);
  }
  for (const speed_t none : {B110, B0}) {  // no rate of ours; hung up
    cfsetspeed(&settings, none);
    ASSERT_EQ(tcsetattr(host.get(), TCSANOW, &settings), 0);
    EXPECT_EQ(pty->baud(), 0);
  }
}

TEST(Pty, BytesOfAHostThatIsGoneAreStillThere) {
  const TestFolder folder;
  const auto pty = opened(folder.file("port"));
  {
    const Descriptor host = open_host(pty->link());
    ASSERT_EQ(::write(host.get(), "abc", 3), 3);
  }
  EXPECT_FALSE(pty->host_present());
  std::array<std::uint8_t, 8> buffer{};
  EXPECT_EQ(receive(*pty, 3), (Bytes{'a', 'b', 'c'}));
  EXPECT_EQ(pty->read(buffer), 0u);  // EIO, not an endless stream
}

TEST(Pty, HostThatIsKilledIsNoticed) {
  const TestFolder folder;
  const auto pty = opened(folder.file("port"));
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const int host = ::open(pty->link().c_str(), O_RDWR | O_NOCTTY);
    const char answer = host >= 0 ? 'y' : 'n';
    if (::write(ready[1], &answer, 1) != 1) ::_exit(1);
    ::pause();
    ::_exit(0);
  }
  char answer = 0;
  ASSERT_EQ(::read(ready[0], &answer, 1), 1);
  EXPECT_EQ(answer, 'y');
  EXPECT_TRUE(pty->host_present());
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_FALSE(pty->host_present());
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST(Pty, NextHostDoesNotHearOldBytes) {
  const TestFolder folder;
  const auto pty = opened(folder.file("port"));
  {
    const Descriptor host = open_host(pty->link());
    EXPECT_EQ(pty->write(Bytes{1, 2, 3}), 3u);
    int there = 0;  // the kernel takes its time to carry them over
    while (there < 3) ASSERT_EQ(::ioctl(host.get(), FIONREAD, &there), 0);
  }
  pty->discard_unread();
  const Descriptor host(::open(pty->link().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  std::array<std::uint8_t, 8> buffer{};
  EXPECT_LE(::read(host.get(), buffer.data(), buffer.size()), 0);
}

TEST(Pty, LinkIsRemovedWithItAndReplacesAStaleOne) {
  const TestFolder folder;
  const std::string link = folder.file("port");
  std::filesystem::create_symlink("/dev/pts/99999", link);
  {
    const auto pty = opened(link);
    EXPECT_EQ(std::filesystem::read_symlink(link), pty->port());
  }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(link)));
}

// A dangling link may be anybody's: only those into /dev/pts are ours.
TEST(Pty, LeavesLinksThatAreNotItsOwn) {
  const TestFolder folder;
  const auto other = opened(folder.file("other"));  // a live port, of socat for example
  const std::string link = folder.file("port");
  std::ofstream(folder.file("notes.txt")) << "mine";
  for (const std::string& target :
       {folder.file("notes.txt"), folder.file("not-yet-there"), std::string("/dev/null"),
        std::string("/dev/pts/../gone"), std::string("/dev/pts/"), std::string("../dev/pts/99999"),
        other->port()}) {
    std::filesystem::create_symlink(target, link);
    const auto pty = Pty::open(link);
    ASSERT_FALSE(pty) << target;
    EXPECT_EQ(pty.error().fault, Fault::usage);
    EXPECT_NE(pty.error().message.find(link), std::string::npos) << pty.error().message;
    EXPECT_EQ(std::filesystem::read_symlink(link), target);
    std::filesystem::remove(link);
  }
}

// The number of a killed board's pty may have been given to a terminal since.
TEST(Pty, ReplacesTheLinkOfABoardThatIsKnownToBeDead) {
  const TestFolder folder;
  const auto other = opened(folder.file("other"));
  const std::string link = folder.file("port");
  std::filesystem::create_symlink(other->port(), link);
  const auto pty = Pty::open(link, true);
  ASSERT_TRUE(pty) << pty.error().message;
  EXPECT_EQ(std::filesystem::read_symlink(link), (*pty)->port());
  std::filesystem::create_symlink("/dev/null", folder.file("null"));
  EXPECT_FALSE(Pty::open(folder.file("null"), true));
}

TEST(Pty, LeavesALinkThatSomebodyElseHasPutThere) {
  const TestFolder folder;
  const std::string link = folder.file("port");
  auto pty = opened(link);
  std::filesystem::remove(link);
  std::filesystem::create_symlink("/dev/null", link);
  pty.reset();
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

TEST(Pty, DoesNotOverwriteAFile) {
  const TestFolder folder;
  const std::string path = folder.file("notes.txt");
  std::ofstream(path) << "mine";
  const auto pty = Pty::open(path);
  ASSERT_FALSE(pty);
  EXPECT_EQ(pty.error().fault, Fault::usage);
  EXPECT_NE(pty.error().message.find(path), std::string::npos);
  std::string content;
  std::getline(std::ifstream(path), content);
  EXPECT_EQ(content, "mine");
}

}  // namespace
}  // namespace kaz::sim
