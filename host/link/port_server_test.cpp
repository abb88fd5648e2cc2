// What clients of `kaz serve-port` can do to a port, and in which order: a recorded port behind the server.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/port_server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "host/link/wall_clock.h"
#include "shared/base/no_descriptors_testing.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;
using namespace telnet;
using Bytes = std::vector<std::uint8_t>;
using Log = std::vector<std::string>;

// Writes down what reaches the board, in order.
struct RecordedPort final : PortLink {
  std::string name() const override { return "the port"; }
  LowLatency low_latency() const override { return LowLatency::set; }
  int descriptor() const override { return -1; }
  Result<std::size_t> read(std::span<std::uint8_t>, Time) override { return 0; }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    log.emplace_back(bytes.begin(), bytes.end());
    return {};
  }
  Result<void> set_baud(int baud) override {
    log.push_back("baud " + std::to_string(baud));
    return {};
  }
  Result<void> set_dtr_rts(bool dtr, bool rts) override {
    if (!has_lines) return fail(Fault::environment, "no lines");
    log.push_back("dtr " + std::to_string(dtr) + " rts " + std::to_string(rts));
    return {};
  }
  bool drained() const override { return --undrained < 0; }
  void purge(bool received, bool unsent) override {
    log.push_back("purge" + std::string(received ? " received" : "") + (unsent ? " unsent" : ""));
  }

  mutable int undrained = 0;  // so often it is not drained yet
  bool has_lines = true;
  Log log;
};

Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}
Bytes com_port(ComPort command, const Bytes& data) {
  Bytes wire;
  put_com_port(command, data, wire);
  return wire;
}
Bytes option(std::uint8_t verb, std::uint8_t what) {
  return {kIac, verb, what};
}
Bytes operator+(Bytes all, const Bytes& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}
const Bytes kAgreement = option(kWill, kComPort);
const Bytes kBegin = {0xff};  // of what is no browser

struct ServedPort : testing::Test {
  void open(PortServer::Protocol protocol) {
    server =
        PortServer::open(port, {.protocol = protocol,
                                .interrupt = &interrupt,
                                .report = [this](const std::string& line) { said += line + "\n"; }})
            .value();
  }
  Descriptor connect() const {
    Descriptor client(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    connect(client);
    return client;
  }
  void connect(const Descriptor& client) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(server->port());
    ASSERT_EQ(::connect(client.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  void send(const Descriptor& client, const Bytes& bytes) {
    ASSERT_EQ(::send(client.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  // As LineBridge does, until `more` is false or nothing has happened for a while.
  void serve(Time quiet = 50ms) {
    std::array<std::uint8_t, 4096> bytes;
    while (true) {
      const auto count = server->read(bytes, WallClock().now() + quiet);
      ASSERT_TRUE(count) << count.error().message;
      if (*count == 0) return;
      ASSERT_TRUE(port.write(std::span(bytes).first(*count)));
    }
  }
  // Replies to commands of RFC 2217 that have come to the client.
  std::vector<Command> replies(const Descriptor& client) {
    std::array<std::uint8_t, 4096> bytes;
    const ssize_t n = ::recv(client.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    std::span<const std::uint8_t> left =
        std::span(bytes).first(n > 0 ? static_cast<std::size_t>(n) : 0);
    std::vector<Command> all;
    Reader reader;
    while (auto command = reader.take(left)) {
      if (command->verb == kSb) all.push_back(*command);
    }
    return all;
  }
  // Whether the server has closed the connection.
  static bool closed(const Descriptor& client) {
    std::array<std::uint8_t, 4096> bytes;
    ssize_t n = 1;
    while (n > 0) n = ::recv(client.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    return n == 0 || errno != EAGAIN;
  }

  Interrupt interrupt;
  RecordedPort port;
  std::string said;
  std::unique_ptr<PortServer> server;
};

TEST_F(ServedPort, BytesAndCommandsOfOneSegmentKeepTheirOrder) {
  open(PortServer::Protocol::rfc2217);
  const Descriptor client = connect();
  send(client, kAgreement + bytes_of("BEFORE") + com_port(kBaudRate, big_endian(9600)) +
                   bytes_of("AFTER") + com_port(kControl, {kDtrOff}) + bytes_of("RESET") +
                   com_port(kPurge, {kPurgeUnsent}) + bytes_of("END"));
  serve();
  EXPECT_EQ(port.log,
            (Log{"BEFORE", "baud 9600", "AFTER", "dtr 0 rts 1", "RESET", "purge unsent", "END"}));
  const auto answers = replies(client);
  ASSERT_EQ(answers.size(), 3u);
  EXPECT_EQ(read_big_endian(answers[0].data), 9600u);
  EXPECT_EQ(answers[1].data, Bytes{kDtrOff});
  EXPECT_EQ(answers[2].data, Bytes{kPurgeUnsent});
}

TEST_F(ServedPort, AClientThatHasLeftIsReadToItsEnd) {
  open(PortServer::Protocol::raw);
  {
    const Descriptor client = connect();
    send(client, kBegin + bytes_of("abcdef"));
  }
  std::array<std::uint8_t, 4> few;
  std::string all;
  for (std::size_t count = 1; count > 0;) {
    count = server->read(few, WallClock().now() + 50ms).value();
    all.append(few.begin(), few.begin() + count);
  }
  EXPECT_EQ(all,
            "\xff"
            "abcdef");
}

// It dies with bytes unread, for example: its connection is reset, and the next write to it fails.
TEST_F(ServedPort, AClientThatDiesWhileTheBoardTalksIsReadToItsEnd) {
  for (const auto protocol : {PortServer::Protocol::raw, PortServer::Protocol::rfc2217}) {
    open(protocol);
    port.log.clear();
    Descriptor client = connect();
    if (protocol == PortServer::Protocol::rfc2217) send(client, kAgreement);
    serve();
    ASSERT_TRUE(server->has_client());
    // The second command's answer cannot be sent either.
    const bool raw = protocol == PortServer::Protocol::raw;
    send(client, (raw ? kBegin : com_port(kBaudRate, big_endian(9600))) + bytes_of("STOP"));
    const linger reset{1, 0};
    ::setsockopt(client.get(), SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
    client = {};
    ASSERT_TRUE(server->write(bytes_of("from the board")));
    const Descriptor next = connect();
    serve();
    EXPECT_EQ(port.log, raw ? Log{"\xffSTOP"} : (Log{"baud 9600", "STOP"}));
    EXPECT_TRUE(server->has_client()) << "the next one";
    EXPECT_FALSE(closed(next));
  }
}

TEST_F(ServedPort, AClientThatTakesNoBytesIsReadToItsEnd) {
  open(PortServer::Protocol::raw);
  const Descriptor client = connect();
  serve();
  send(client, kBegin + bytes_of("STOP"));
  const Bytes much(65536);
  for (int i = 0; i < 1000 && said.find("no longer reads the bytes") == std::string::npos; ++i) {
    ASSERT_TRUE(server->write(much));
    if (i % 100 == 99) serve(1ms);
  }
  EXPECT_EQ(port.log, Log{"\xffSTOP"});
  EXPECT_FALSE(server->has_client());
}

TEST_F(ServedPort, TheRateChangesWhenThePortHasSentWhatCameBefore) {
  open(PortServer::Protocol::rfc2217);
  const Descriptor client = connect();
  port.undrained = 20;
  send(client,
       kAgreement + bytes_of("BEFORE") + com_port(kBaudRate, big_endian(9600)) + bytes_of("AFTER"));
  std::array<std::uint8_t, 4096> bytes;
  for (int i = 0; i < 10; ++i) {
    const auto count = server->read(bytes, WallClock().now());
    ASSERT_TRUE(count);
    if (*count > 0) {
      ASSERT_TRUE(port.write(std::span(bytes).first(*count)));
    }
  }
  EXPECT_EQ(port.log, Log{"BEFORE"}) << "with " << port.undrained << " checks to go";
  EXPECT_EQ(server->descriptor(), -1) << "or a bridge would spin";
  EXPECT_TRUE(server->has_unsent());
  serve();
  EXPECT_EQ(port.log, (Log{"BEFORE", "baud 9600", "AFTER"}));
}

TEST_F(ServedPort, AClientWhoseBytesThePortDoesNotSendIsDisconnected) {
  open(PortServer::Protocol::rfc2217);
  const Descriptor client = connect();
  port.undrained = 1'000'000;
  send(client, kAgreement + bytes_of("BEFORE") + com_port(kBaudRate, big_endian(9600)));
  serve(5500ms);
  EXPECT_EQ(port.log, Log{"BEFORE"});
  EXPECT_FALSE(server->has_client());
  EXPECT_NE(said.find("did not send the client's bytes within 5 s"), std::string::npos) << said;
}

TEST_F(ServedPort, NothingReachesThePortBeforeOption44) {
  open(PortServer::Protocol::rfc2217);
  const Descriptor client = connect();
  send(client, option(kDont, kEcho) + bytes_of("EARLY") + com_port(kBaudRate, big_endian(9600)) +
                   com_port(kControl, {kDtrOff}) + com_port(kControl, {kRtsOff}) +
                   com_port(kPurge, {3}) + option(kWont, kComPort) + option(kWill, kBinary) +
                   bytes_of("EARLY"));
  serve();
  EXPECT_EQ(port.log, Log{});
  EXPECT_TRUE(replies(client).empty());
  EXPECT_NE(
      said.find(
          " sent bytes before it agreed to RFC 2217 (telnet option 44); these bytes were dropped"),
      std::string::npos)
      << said;
  send(client, kAgreement + bytes_of("NOW"));
  serve();
  EXPECT_EQ(port.log, Log{"NOW"});
}

TEST_F(ServedPort, TheBoardsBytesAreOnlyForAClientThatHasAgreedToOption44) {
  open(PortServer::Protocol::rfc2217);
  const Descriptor client = connect();
  const auto received = [&] {
    std::array<char, 4096> bytes;
    const ssize_t n = ::recv(client.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    return std::string(bytes.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
  };
  serve();
  const std::string offers = received();
  EXPECT_NE(offers, "");
  EXPECT_EQ(offers.find(static_cast<char>(kComPort)), std::string::npos)
      << "pyserial would take it for the answer to its own, and not send that";
  ASSERT_TRUE(server->write(bytes_of("EARLY")));
  EXPECT_EQ(received(), "");
  send(client, kAgreement);
  serve();
  const Bytes agreed = option(kDo, kComPort);
  EXPECT_EQ(received(), std::string(agreed.begin(), agreed.end()));
  ASSERT_TRUE(server->write(bytes_of("NOW")));
  EXPECT_EQ(received(), "NOW");
}

// RFC 2217, PURGE-DATA: the buffers are the server's.
TEST_F(ServedPort, PurgesTheBuffersThatAreNamed) {
  open(PortServer::Protocol::rfc2217);
  const Descriptor client = connect();
  send(client, kAgreement + com_port(kPurge, {1}) + com_port(kPurge, {2}) + com_port(kPurge, {3}));
  serve();
  EXPECT_EQ(port.log, (Log{"purge received", "purge unsent", "purge received unsent"}));
}

// Clients such as pyserial's switch both on when they open a port, and take no other answer.
TEST_F(ServedPort, LinesThatThePortLacksAreAlwaysOn) {
  open(PortServer::Protocol::rfc2217);
  port.has_lines = false;
  const Descriptor client = connect();
  send(client, kAgreement + com_port(kControl, {kDtrOn}) + com_port(kControl, {kRtsOn}) +
                   com_port(kControl, {kDtrOff}) + com_port(kControl, {kQueryRts}));
  serve();
  Bytes values;
  for (const Command& reply : replies(client)) values = values + reply.data;
  EXPECT_EQ(values, (Bytes{kDtrOn, kRtsOn, kDtrOn, kRtsOn}));
}

// What a browser sends for fetch(URL, {method: "POST", mode: "no-cors", body}), whatever page it shows.
TEST_F(ServedPort, AWebPagesRequestIsDroppedWhole) {
  const std::string head = " / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 20\r\n\r\n";
  const Bytes body = kAgreement + com_port(kBaudRate, big_endian(9600)) + Bytes{0, 1, 8, 0, 0, 2};
  for (const auto protocol : {PortServer::Protocol::raw, PortServer::Protocol::rfc2217}) {
    for (const std::string method : {"POST", "PROPFIND", "x"}) {
      open(protocol);
      said.clear();
      const Descriptor page = connect();
      send(page, bytes_of(method + head) + body);
      serve();
      EXPECT_EQ(port.log, Log{});
      EXPECT_FALSE(server->has_client());
      EXPECT_TRUE(closed(page));
      EXPECT_NE(said.find("first bytes can come from a web browser"), std::string::npos) << said;
    }
  }
  // The next client is served as ever.
  const Descriptor client = connect();
  send(client, kAgreement + bytes_of("GET "));
  serve();
  EXPECT_EQ(port.log, Log{"GET "});
}

// A browser connects ahead of a request that may never come.
TEST_F(ServedPort, AClientThatDoesNotUseThePortGivesWayToTheNextOne) {
  for (const auto protocol : {PortServer::Protocol::raw, PortServer::Protocol::rfc2217}) {
    open(protocol);
    port.log.clear();
    const Descriptor silent = connect();
    serve();
    ASSERT_FALSE(closed(silent));
    const Descriptor early = connect();
    if (protocol == PortServer::Protocol::rfc2217)
      send(early, option(kDont, kEcho) + bytes_of("EARLY"));
    serve();
    EXPECT_TRUE(closed(silent));
    EXPECT_FALSE(closed(early));
    const Descriptor client = connect();
    send(client, kAgreement + bytes_of("NOW"));
    const Descriptor late = connect();
    serve();
    EXPECT_TRUE(closed(early));
    EXPECT_TRUE(closed(late)) << "the one before had spoken, although nobody had read it";
    EXPECT_FALSE(closed(client));
    ASSERT_EQ(port.log.size(), 1u);
    EXPECT_TRUE(port.log.front().ends_with("NOW"));
    EXPECT_NE(said.find("it had not used the port"), std::string::npos) << said;
  }
}

TEST_F(ServedPort, AFloodOfClientsDoesNotHoldUpTheBoard) {
  std::vector<Descriptor> clients;
  int refused = 0;
  const auto report = [&](const std::string& line) {
    if (line.find("was refused") == std::string::npos) return;
    if (++refused < 100) clients.push_back(connect());  // faster than they are refused
  };
  server = PortServer::open(port, {.report = report}).value();
  const Descriptor first = connect();
  send(first, kBegin);
  serve();
  clients.push_back(connect());
  ASSERT_TRUE(server->write(bytes_of("from the board")));
  EXPECT_GE(refused, 1);
  EXPECT_LE(refused, 8);
  serve();
  EXPECT_EQ(refused, 100) << "all of them at last";
}

Time thread_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::chrono::seconds(now.tv_sec) + Time(now.tv_nsec);
}

TEST_F(ServedPort, WithoutADescriptorItWaitsAndThenServesTheClient) {
  open(PortServer::Protocol::raw);
  const Descriptor client(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  // Without the pause read() never returns.
  std::atomic<bool> served = false;
  std::thread watchdog([&] {
    for (int i = 0; i < 500 && !served; ++i) std::this_thread::sleep_for(10ms);
    interrupt.request();
  });
  {
    const NoDescriptors none;
    connect(client);
    std::array<std::uint8_t, 8> bytes;
    const Time begin = WallClock().now(), used = thread_time();
    const auto count = server->read(bytes, begin + 450ms);
    EXPECT_TRUE(count) << count.error().message;
    EXPECT_GE(WallClock().now() - begin, 450ms);
    EXPECT_LT(thread_time() - used, 100ms) << "it spins";
    EXPECT_FALSE(server->has_client());
  }
  send(client, kBegin);
  serve(500ms);
  EXPECT_EQ(port.log, Log{"\xff"});
  served = true;
  watchdog.join();
}

}  // namespace
}  // namespace kaz::host
