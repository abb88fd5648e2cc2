// tcp: and rfc2217: over loopback, both ends: links, the server, the bridge behind it, telnet's codec.
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "host/link/line_bridge.h"
#include "host/link/port_server.h"
#include "host/link/rfc2217_link.h"
#include "host/link/tcp_link.h"
#include "host/link/tcp_socket.h"
#include "host/link/telnet.h"
#include "host/link/tty_link.h"
#include "host/link/wall_clock.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

Bytes all_bytes() {
  Bytes bytes(256);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
  return bytes;
}

Bytes read_some(PortLink& link, std::size_t count, Time patience = 2s) {
  Bytes all;
  const Time until = WallClock().now() + patience;
  while (all.size() < count && WallClock().now() < until) {
    std::array<std::uint8_t, 100> some;
    const auto n = link.read(some, until);
    EXPECT_TRUE(n) << n.error().message;
    if (!n) break;
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(*n));
  }
  return all;
}

// The pty at which a board would be, and a server of its port in a thread, as `kaz serve-port` has it.
class Served {
 public:
  explicit Served(PortServer::Protocol protocol) {
    int slave = -1;
    char name[64] = {};
    if (openpty(&master_, &slave, name, nullptr, nullptr) != 0) throw std::runtime_error("openpty");
    close(slave);
    line_ = TtyLink::open(name, 115200, &interrupt_).value();
    server_ = PortServer::open(*line_, {.protocol = protocol,
                                        .interrupt = &interrupt_,
                                        .report = [this](const std::string& line) { say(line); }})
                  .value();
    bridge_.emplace(*line_, *server_, interrupt_, [this](const std::string& line) { say(line); });
    thread_ = std::thread([this] { EXPECT_TRUE(bridge_->run()); });
  }
  ~Served() {
    interrupt_.request();
    thread_.join();
    close(master_);
  }
  PortAddress address(PortKind kind) const { return {kind, "127.0.0.1", server_->port()}; }
  void send(const Bytes& bytes) {
    ASSERT_EQ(::write(master_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  Bytes receive(std::size_t count) {
    Bytes bytes(count);
    std::size_t done = 0;
    while (done < count) {
      const ssize_t n = ::read(master_, bytes.data() + done, count - done);
      if (n <= 0) break;
      done += static_cast<std::size_t>(n);
    }
    bytes.resize(done);
    return bytes;
  }
  speed_t speed() const {
    termios settings{};
    tcgetattr(master_, &settings);
    return cfgetospeed(&settings);
  }
  bool said(const std::string& part) {
    const std::lock_guard lock(mutex_);
    return text_.find(part) != std::string::npos;
  }
  bool says(const std::string& part) {
    for (int i = 0; i < 200 && !said(part); ++i) std::this_thread::sleep_for(10ms);
    return said(part);
  }

 private:
  void say(const std::string& line) {
    const std::lock_guard lock(mutex_);
    text_ += line + "\n";
  }
  int master_ = -1;
  Interrupt interrupt_;
  std::unique_ptr<TtyLink> line_;
  std::unique_ptr<PortServer> server_;
  std::optional<LineBridge> bridge_;
  std::thread thread_;
  std::mutex mutex_;
  std::string text_;
};

TEST(TcpLink, CarriesEveryByteBothWays) {
  Served board(PortServer::Protocol::raw);
  auto link = TcpLink::open(board.address(PortKind::tcp));
  ASSERT_TRUE(link) << link.error().message;
  ASSERT_TRUE((*link)->write(all_bytes()));
  EXPECT_EQ(board.receive(256), all_bytes());
  board.send(all_bytes());
  EXPECT_EQ(read_some(**link, 256), all_bytes());
}

TEST(TcpLink, AServerOfRfc2217IsNamedAsSuch) {
  Served board(PortServer::Protocol::rfc2217);
  auto link = TcpLink::open(board.address(PortKind::tcp));
  ASSERT_TRUE(link) << link.error().message;
  std::array<std::uint8_t, 100> some;
  const Time until = WallClock().now() + 5s;
  auto read = (*link)->read(some, until);
  while (read && WallClock().now() < until) read = (*link)->read(some, until);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().fault, Fault::environment);
  const std::string place = (*link)->name().substr(4);
  EXPECT_EQ(read.error().message, "tcp:" + place +
                                      ": an RFC 2217 server answers at this address, and its "
                                      "commands are not bytes of the board; give rfc2217:" +
                                      place);
}

// A board may send anything, if not just Telnet's first words.
TEST(TcpLink, BytesLikeTelnetsAreTheBoards) {
  for (const Bytes& bytes : {Bytes{0xff, 0xfb, 0x2c, 0xff, 0x03, 0x00}, Bytes(6, 0xff),
                             Bytes{0x00, 0xff, 0xfb, 0x2c, 0xff, 0xfd}}) {
    Served board(PortServer::Protocol::raw);
    auto link = TcpLink::open(board.address(PortKind::tcp));
    ASSERT_TRUE(link) << link.error().message;
    board.send(bytes);
    EXPECT_EQ(read_some(**link, 6), bytes);
  }
}

TEST(Rfc2217Link, CarriesEveryByteBothWaysAndTheRate) {
  Served board(PortServer::Protocol::rfc2217);
  auto link = Rfc2217Link::open(board.address(PortKind::rfc2217));
  ASSERT_TRUE(link) << link.error().message;
  EXPECT_EQ(board.speed(), speed_t{B115200});
  ASSERT_TRUE((*link)->write(all_bytes()));
  EXPECT_EQ(board.receive(256), all_bytes());
  board.send(all_bytes());
  EXPECT_EQ(read_some(**link, 256), all_bytes());

  ASSERT_TRUE((*link)->set_baud(57600));
  EXPECT_EQ(board.speed(), speed_t{B57600});
  const auto odd = (*link)->set_baud(12345);
  ASSERT_FALSE(odd);
  EXPECT_EQ(odd.error().message,
            (*link)->name() + " cannot set its port to 12345 baud; it stays at 57600");
  const auto lines = (*link)->set_dtr_rts(true, false);
  ASSERT_FALSE(lines) << "a pseudo-terminal has none";
  EXPECT_NE(lines.error().message.find("has no lines DTR and RTS"), std::string::npos);
  ASSERT_TRUE((*link)->write(all_bytes()));
  EXPECT_EQ(board.receive(256), all_bytes());
}

TEST(PortServer, ASecondClientIsRefusedAndTheNextOneComes) {
  Served board(PortServer::Protocol::raw);
  auto first = TcpLink::open(board.address(PortKind::tcp));
  ASSERT_TRUE(first);
  ASSERT_TRUE((*first)->write(Bytes{0}));
  ASSERT_EQ(board.receive(1), Bytes{0});
  auto second = TcpLink::open(board.address(PortKind::tcp));
  ASSERT_TRUE(second);
  std::array<std::uint8_t, 8> some;
  const auto closed = (*second)->read(some, WallClock().now() + 2s);
  ASSERT_FALSE(closed);
  EXPECT_NE(closed.error().message.find("was closed by the other end"), std::string::npos);
  EXPECT_TRUE(board.said("was refused"));

  first->reset();
  ASSERT_TRUE(board.says(" left"));
  ASSERT_TRUE((*second)->reopen());
  board.send({1, 2, 3});
  EXPECT_EQ(read_some(**second, 3), (Bytes{1, 2, 3}));
}

TEST(TcpLink, APeerThatLeavesIsLostAndFoundAgain) {
  auto listener = listen_tcp("127.0.0.1", 0);
  ASSERT_TRUE(listener);
  const PortAddress address{PortKind::tcp, "127.0.0.1", port_of(listener->get())};
  auto link = TcpLink::open(address);
  ASSERT_TRUE(link);
  std::string peer;
  { const Descriptor gone = accept_tcp(listener->get(), peer); }
  std::array<std::uint8_t, 8> some;
  EXPECT_FALSE((*link)->read(some, WallClock().now() + 2s));
  EXPECT_FALSE((*link)->write(some)) << "and so do later calls";
  ASSERT_TRUE((*link)->reopen());
  const Descriptor again = accept_tcp(listener->get(), peer);
  ASSERT_TRUE(again);
  ASSERT_EQ(::send(again.get(), "abc", 3, 0), 3);
  EXPECT_EQ(read_some(**link, 3), (Bytes{'a', 'b', 'c'}));
}

TEST(TcpLink, EachFailureHasItsSentence) {
  std::uint16_t unused = 0;
  {
    const auto listener = listen_tcp("127.0.0.1", 0);
    ASSERT_TRUE(listener);
    unused = port_of(listener->get());
    const auto twice = listen_tcp("127.0.0.1", unused);
    ASSERT_FALSE(twice);
    EXPECT_EQ(twice.error().message,
              "another program listens on 127.0.0.1:" + std::to_string(unused) +
                  ": end that program, or give another port");
  }
  const auto refused = TcpLink::open({PortKind::tcp, "127.0.0.1", unused});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::environment);
  EXPECT_NE(refused.error().message.find(" refused the connection: no server listens on that port"),
            std::string::npos);
  const auto nobody = TcpLink::open({PortKind::tcp, "kaz-none.invalid", 7000});
  ASSERT_FALSE(nobody);
  EXPECT_EQ(nobody.error().fault, Fault::environment);
  EXPECT_NE(nobody.error().message.find("kaz-none.invalid"), std::string::npos);
}

// A server of bytes alone says nothing of options; one that declines says so at once.
TEST(Rfc2217Link, APeerThatDoesNotSpeakItIsASentence) {
  auto listener = listen_tcp("127.0.0.1", 0);
  ASSERT_TRUE(listener);
  std::thread server([&] {
    std::string peer;
    Descriptor client;
    for (int i = 0; i < 200 && !client; ++i) {
      client = accept_tcp(listener->get(), peer);
      std::this_thread::sleep_for(5ms);
    }
    const Bytes dont{telnet::kIac, telnet::kDont, telnet::kComPort};
    (void)::send(client.get(), dont.data(), dont.size(), 0);
    std::this_thread::sleep_for(100ms);
  });
  const auto link = Rfc2217Link::open({PortKind::rfc2217, "127.0.0.1", port_of(listener->get())});
  server.join();
  ASSERT_FALSE(link);
  EXPECT_NE(link.error().message.find("does not support RFC 2217: give tcp:127.0.0.1:"),
            std::string::npos)
      << link.error().message;
}

// A server of RFC 2217 that agrees to everything at once, sends the replies that set_up() waits for, and then
// `flood` so many times.
class FloodingServer {
 public:
  explicit FloodingServer(Bytes flood, bool agrees = true, int times = 1'000'000'000) {
    listener_ = listen_tcp("127.0.0.1", 0).value();
    thread_ = std::thread([this, flood = std::move(flood), agrees, times] {
      std::string peer;
      Descriptor client;
      while (!ended_ && !client) {
        client = accept_tcp(listener_.get(), peer);
        std::this_thread::sleep_for(1ms);
      }
      fcntl(client.get(), F_SETFL, 0);  // each send() is whole
      Bytes wire;
      if (agrees) {
        telnet::put_option(telnet::kDo, telnet::kComPort, wire);
        telnet::put_com_port(telnet::ComPort(telnet::kBaudRate + telnet::kReply),
                             telnet::big_endian(115200), wire);
        telnet::put_com_port(telnet::ComPort(telnet::kPurge + telnet::kReply), {{3}}, wire);
      }
      (void)::send(client.get(), wire.data(), wire.size(), MSG_NOSIGNAL);
      for (int i = 0; i < times && !ended_; ++i)
        (void)::send(client.get(), flood.data(), flood.size(), MSG_NOSIGNAL);
      while (!ended_) std::this_thread::sleep_for(1ms);
    });
  }
  ~FloodingServer() {
    ended_ = true;
    thread_.join();
  }
  PortAddress address() const { return {PortKind::rfc2217, "127.0.0.1", port_of(listener_.get())}; }

 private:
  Descriptor listener_;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

TEST(Rfc2217Link, APeerThatFloodsTheLinkIsAnErrorAndNoMemory) {
  FloodingServer server(Bytes(10000, 'x'));
  auto link = Rfc2217Link::open(server.address());
  ASSERT_TRUE(link) << link.error().message;
  // No answer comes to this one, only data.
  const auto set = (*link)->set_baud(57600);
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().fault, Fault::environment);
  EXPECT_EQ(set.error().message,
            (*link)->name() +
                " sent more than 1048576 bytes before the reply to a command, which is not "
                "possible for a serial port: check the server at this address");
}

TEST(Rfc2217Link, AFloodBeforeTheAgreementEndsAtTheDeadline) {
  FloodingServer server(Bytes(10000, 'x'), false);
  const Time begin = WallClock().now();
  const auto link = Rfc2217Link::open(server.address());
  ASSERT_FALSE(link);
  EXPECT_NE(link.error().message.find("does not support RFC 2217"), std::string::npos)
      << link.error().message;
  EXPECT_LT(WallClock().now() - begin, 5s);
}

// Line states, for example, which are no data. A server that sends them faster than they are read must not
// keep the reader: what is left shows that it did not go on to the end.
TEST(Rfc2217Link, CommandsWithoutEndDoNotKeepTheReader) {
  Bytes notices;
  for (int i = 0; i < 1000; ++i)
    telnet::put_com_port(telnet::ComPort(telnet::kNotifyLineState + telnet::kReply), {{0}},
                         notices);
  FloodingServer server(notices, true, 10);
  auto link = Rfc2217Link::open(server.address());
  ASSERT_TRUE(link) << link.error().message;
  const auto waiting = [&link] {
    int bytes = 0;
    EXPECT_EQ(ioctl((*link)->descriptor(), FIONREAD, &bytes), 0);
    return bytes;
  };
  for (int i = 0; i < 500 && waiting() < 20000; ++i) std::this_thread::sleep_for(10ms);
  std::array<std::uint8_t, 8> some;
  EXPECT_EQ((*link)->read(some, WallClock().now()).value(), 0u);
  EXPECT_GT(waiting(), 10000);
}

// All commands in pieces of `piece` bytes; the data before each, and after the last, to `data`.
std::vector<telnet::Command> take_all(telnet::Reader& reader, const Bytes& wire, std::size_t piece,
                                      std::vector<Bytes>* data) {
  std::vector<telnet::Command> commands;
  for (std::size_t at = 0; at < wire.size(); at += piece) {
    std::span<const std::uint8_t> left = std::span(wire).subspan(at);
    left = left.first(std::min(piece, left.size()));
    while (!left.empty()) {
      auto command = reader.take(left);
      const auto some = reader.take_data();
      data->back().insert(data->back().end(), some.begin(), some.end());
      if (!command) continue;
      commands.push_back(*std::move(command));
      data->emplace_back();
    }
  }
  return commands;
}

TEST(Telnet, DataWithIacAndCommandsInPiecesOfAnySize) {
  using namespace telnet;
  Bytes wire;
  put_data(all_bytes(), wire);
  put_com_port(kBaudRate, big_endian(0xFFFF0001), wire);
  put_option(kWill, kComPort, wire);
  put_data({{255, 1}}, wire);
  for (const std::size_t piece : {std::size_t{1}, std::size_t{3}, wire.size()}) {
    Reader reader;
    std::vector<Bytes> data(1);
    const auto commands = take_all(reader, wire, piece, &data);
    EXPECT_EQ(data, (std::vector<Bytes>{all_bytes(), {}, {255, 1}})) << "each before its command";
    ASSERT_EQ(commands.size(), 2u);
    EXPECT_EQ(commands[0].verb, kSb);
    EXPECT_EQ(commands[0].what, kBaudRate);
    EXPECT_EQ(read_big_endian(commands[0].data), 0xFFFF0001u);
    EXPECT_EQ(commands[1].verb, kWill);
    EXPECT_EQ(reader.dropped(), 0u);
  }
}

TEST(Telnet, LongBrokenAndForeignSubNegotiationsAreDroppedAndCounted) {
  using namespace telnet;
  Reader reader;
  Bytes wire;
  put_com_port(kSignature, Bytes(100000, 'x'), wire);
  wire.insert(wire.end(), {kIac, kSb, 24, 1, kIac, kSe});  // terminal type
  wire.insert(wire.end(),
              {kIac, kSb, kComPort, kIac, kDo, kEcho});  // broken off by another command
  wire.push_back('y');
  std::vector<Bytes> data(1);
  const auto commands = take_all(reader, wire, wire.size(), &data);
  EXPECT_EQ(reader.dropped(), 3u);
  EXPECT_EQ(data.back(), Bytes{'y'});
  ASSERT_EQ(commands.size(), 1u);
  EXPECT_EQ(commands[0].verb, kDo);
}

// Two ends that answer each other must come to rest.
TEST(Telnet, NegotiationOfTwoEndsEnds) {
  telnet::Options a, b;
  Bytes to_a, to_b;
  a.begin(telnet::End::client, to_b);
  b.begin(telnet::End::server, to_a);
  telnet::put_option(telnet::kWill, telnet::kEcho, to_b);
  telnet::put_option(telnet::kDo, 31, to_a);
  int rounds = 0;
  for (; rounds < 10 && !(to_a.empty() && to_b.empty()); ++rounds) {
    telnet::Reader at_a, at_b;
    std::vector<Bytes> none(1);
    const auto for_a = take_all(at_a, std::exchange(to_a, {}), 1000, &none);
    const auto for_b = take_all(at_b, std::exchange(to_b, {}), 1000, &none);
    for (const auto& command : for_a) a.take(command, to_b);
    for (const auto& command : for_b) b.take(command, to_a);
  }
  EXPECT_LE(rounds, 4);
  EXPECT_TRUE(a.com_port());
  EXPECT_TRUE(b.com_port());
}

}  // namespace
}  // namespace kaz::host
