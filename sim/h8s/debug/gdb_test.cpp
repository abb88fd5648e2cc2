// A scripted remote-protocol session, in process and over a socket, and hostile bytes.
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <future>
#include <mutex>
#include <random>
#include <thread>

#include "sim/h8s/debug/debug_testing.h"
#include "sim/h8s/debug/gdb_port.h"

namespace kaz::h8s::testing {
namespace {

// kCode: mov.w #5,r0 ; mov.w r0,@0xffe100:16 ; bsr +2 ; bra . ; inc.l #1,er0 ; rts
Chip small_chip() {
  return make_chip(Program().words({0x7900, 5, 0x6b80, 0xe100, 0x5502, 0x40fe, 0x0b70, 0x5470}));
}
constexpr std::uint32_t kStore = kCode + 4, kCall = kCode + 8, kFunction = kCode + 12;

class Session {
 public:
  explicit Session(Chip& chip) : server(chip, {200, 12}) {}

  // Sends a packet, runs the chip while GDB lets it run; returns the last reply, unescaped.
  std::string send(std::string_view packet) {
    feed(gdb_frame(packet));
    for (int k = 0; k < 1000 && server.running(); ++k) server.run(1000);
    return answer();
  }
  void feed(std::string_view bytes) {
    server.feed({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  }
  std::string answer() {
    std::vector<GdbInput> got;
    const std::string out = server.take_output();
    framing.feed({reinterpret_cast<const std::uint8_t*>(out.data()), out.size()}, got);
    return got.empty() ? "(nothing)" : got.back().data;
  }
  GdbServer server;
  GdbFraming framing;
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Gdb, FramesAndEscapes) {
  EXPECT_EQ(gdb_frame("OK"), "$OK#9a");  // 'O' + 'K' = 0x4f + 0x4b
  EXPECT_EQ(gdb_frame("a}b#"),
            "$a}\x5d"
            "b}\x03#1d");
  GdbFraming framing;
  std::vector<GdbInput> got;
  const std::string bytes =
      "+noise$a}\x5d"
      "b}\x03#1d-\x03$OK#9b";
  for (const char c : bytes) {
    const auto byte = static_cast<std::uint8_t>(c);
    framing.feed({&byte, 1}, got);
  }
  ASSERT_EQ(got.size(), 4u);
  EXPECT_EQ(got[0].data, "a}b#");
  EXPECT_EQ(got[1].kind, GdbInput::Kind::repeat);
  EXPECT_EQ(got[2].kind, GdbInput::Kind::interrupt);
  EXPECT_EQ(got[3].kind, GdbInput::Kind::damaged);
}

TEST(Gdb, RegistersInTheOrderOfTheTarget) {
  Chip chip = small_chip();
  Registers r = chip.registers();
  for (unsigned n = 0; n < 7; ++n) r.er[n] = 0x11111111 * n;
  r.ccr = 0x85;
  chip.set_registers(r);
  Session s(chip);
  EXPECT_EQ(s.send("g"),
            "0000000011111111222222223333333344444444555555556666666600fff000"
            "0000008500001000000000000000007f00000000000000000000000000000000");
  EXPECT_EQ(s.send("p9"), "00001000");
  EXPECT_EQ(s.send("P3=deadbeef"), "OK");
  EXPECT_EQ(chip.registers().er[3], 0xdeadbeefu);
  EXPECT_EQ(s.send("P8=81"), "OK");
  EXPECT_EQ(chip.registers().ccr, 0x81);
  EXPECT_EQ(s.send("Gxxxxxxxx00000001"), "OK");
  EXPECT_EQ(chip.registers().er[1], 1u);
  EXPECT_EQ(s.send("p10"), "E01");
  EXPECT_EQ(s.send("P9=123456789a"), "E01");
  s.send("s");
  EXPECT_EQ(s.send("pa"), "00000002");  // cycles: mov.w #,r0 takes 2 states
  EXPECT_EQ(s.send("pd"), "00000001");
}

TEST(Gdb, MemoryAndFlash) {
  Chip chip = small_chip();
  Session s(chip);
  EXPECT_EQ(s.send("m1000,4"), "79000005");
  EXPECT_EQ(s.send("Mffe200,3:0102ff"), "OK");
  EXPECT_EQ(s.send("mffe1ff,5"), "a50102ffa5");
  EXPECT_EQ(s.send("Xffe200,2:}\x03}\x5d"), "E01");  // escaped once more by the frame
  EXPECT_EQ(s.send(std::string("Xffe200,2:#}")), "OK");
  EXPECT_EQ(s.send("mffe200,2"), "237d");
  EXPECT_EQ(s.send("m20000,1"), "E14");
  EXPECT_EQ(s.send("m1fffe,4"), "ffff");  // as far as there is memory
  EXPECT_EQ(s.send("M30000,1:00"), "E14");
  EXPECT_EQ(s.send("Mffe200,2:00"), "E01");
  EXPECT_EQ(s.send("vFlashErase:1000,400"), "OK");
  EXPECT_EQ(s.send("m1000,2"), "ffff");
  EXPECT_EQ(s.send(std::string("vFlashWrite:1000:\x0b\x70\x40\xfe", 21)), "OK");
  EXPECT_EQ(s.send("vFlashDone"), "OK");
  EXPECT_EQ(s.send("m1000,4"), "0b7040fe");
  EXPECT_TRUE(has(s.send("s"), "09:00001002"));
  EXPECT_EQ(s.send("vFlashWrite:20000:ab"), "E.memtype");
  EXPECT_EQ(s.send("vFlashErase:1fff0,20"), "E14");
  const std::string map = s.send("qXfer:memory-map:read::0,1000");
  EXPECT_TRUE(has(map, "type=\"flash\" start=\"0x00000000\" length=\"0x00020000\""));
  EXPECT_EQ(map[0], 'l');
}

TEST(Gdb, BreakpointsStepsAndGoingBack) {
  Chip chip = small_chip();
  Session s(chip);
  EXPECT_TRUE(has(s.send("qSupported:multiprocess+;swbreak+"), "ReverseContinue+"));
  EXPECT_EQ(s.send("?"), "S05");
  EXPECT_EQ(s.send("Z0,100c,2"), "OK");
  std::string stop = s.send("c");
  EXPECT_TRUE(has(stop, "swbreak:;") && has(stop, "09:0000100c")) << stop;
  EXPECT_TRUE(has(s.send("s"), "09:0000100e"));
  EXPECT_TRUE(has(s.send("vCont;s:1;c"), "09:0000100a"));
  EXPECT_EQ(chip.registers().er[0] & 0xffff, 6u);
  EXPECT_TRUE(has(s.send("bs"), "09:0000100e"));
  EXPECT_TRUE(has(s.send("bs"), "09:0000100c"));
  EXPECT_EQ(chip.registers().er[0] & 0xffff, 5u);
  EXPECT_TRUE(has(s.send("bs"), "09:00001008"));
  stop = s.send("bc");
  EXPECT_TRUE(has(stop, "replaylog:begin;")) << stop;
  EXPECT_EQ(chip.now(), 0);
  stop = s.send("c");
  EXPECT_TRUE(has(stop, "swbreak:;") && has(stop, "09:0000100c")) << stop;
  EXPECT_EQ(s.send("z0,100c,2"), "OK");
  EXPECT_EQ(s.send("Z1,100a,2"), "OK");
  stop = s.send("c");
  EXPECT_TRUE(has(stop, "hwbreak:;") && has(stop, "09:0000100a")) << stop;
  stop = s.send("c");  // bra . comes by again
  EXPECT_TRUE(has(stop, "hwbreak:;") && has(stop, "09:0000100a")) << stop;
}

TEST(Gdb, Watchpoints) {
  Chip chip = small_chip();
  Session s(chip);
  EXPECT_EQ(s.send("Z2,ffe101,1"), "OK");
  std::string stop = s.send("c");
  EXPECT_TRUE(has(stop, "watch:00ffe100;") && has(stop, "09:00001008")) << stop;
  EXPECT_EQ(s.send("z2,ffe101,1"), "OK");
  EXPECT_EQ(s.send("Z4,ffeffc,4"), "OK");  // the return address
  stop = s.send("c");
  EXPECT_TRUE(has(stop, "awatch:00ffeffc;") && has(stop, "09:0000100c")) << stop;
  EXPECT_EQ(s.send("z4,ffeffc,4"), "OK");
  EXPECT_EQ(s.send("Z3,ffeffc,4"), "OK");
  stop = s.send("c");
  EXPECT_TRUE(has(stop, "rwatch:00ffeffc;") && has(stop, "09:0000100a")) << stop;
  EXPECT_EQ(s.send("z3,ffeffc,4"), "OK");
  EXPECT_EQ(s.send("Z2,ffe100,2"), "OK");
  stop = s.send("bc");
  EXPECT_TRUE(has(stop, "watch:00ffe100;") && has(stop, "09:00001004")) << stop;
  EXPECT_EQ(chip.peek16(0xffe100), 0xa5a5);
}

TEST(Gdb, InterruptErrorsAndTheEnd) {
  Chip chip = small_chip();
  Session s(chip);
  s.feed(gdb_frame("c"));
  s.server.run(500);
  EXPECT_TRUE(s.server.running());
  s.feed("\x03");
  EXPECT_TRUE(s.answer().starts_with("T02"));
  EXPECT_FALSE(s.server.running());
  EXPECT_EQ(s.send("Mffe200,2:0001"), "OK");  // not an instruction
  EXPECT_TRUE(s.send("cffe200").starts_with("T04"));
  EXPECT_EQ(s.send("vMustReplyEmpty"), "");
  EXPECT_EQ(s.send("qAttached"), "1");
  EXPECT_EQ(s.send("qfThreadInfo"), "m1");
  EXPECT_EQ(s.send("Hg0"), "OK");
  EXPECT_TRUE(has(s.send("qXfer:features:read:target.xml:0,fff"), ">h8300s<"));
  EXPECT_TRUE(has(s.server.monitor("states"), "states"));
  EXPECT_TRUE(has(s.server.monitor("nonsense"), "monitor help"));
  s.server.monitor("reset");
  EXPECT_EQ(chip.registers().pc, kCode);
  EXPECT_EQ(s.send("D"), "OK");
  EXPECT_TRUE(s.server.finished());
}

TEST(Gdb, AcknowledgementsUntilSwitchedOff) {
  Chip chip = small_chip();
  GdbServer server(chip);
  const auto exchange = [&](const std::string& bytes) {
    server.feed({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    return server.take_output();
  };
  EXPECT_EQ(exchange("$qC#b4"), "+$QC1#c5");
  EXPECT_EQ(exchange("-"), "$QC1#c5");
  EXPECT_EQ(exchange("$qC#00"), "-");
  EXPECT_EQ(exchange("$QStartNoAckMode#b0"), "+$OK#9a");
  EXPECT_EQ(exchange("$qC#b4"), "$QC1#c5");
}

TEST(Gdb, HostileBytesDoNoHarm) {
  std::mt19937 random(7);
  const std::vector<std::string> seeds = {"g",
                                          "G00",
                                          "p0",
                                          "P0=1",
                                          "m0,4",
                                          "M0,1:00",
                                          "X0,1:a",
                                          "c",
                                          "s",
                                          "bs",
                                          "bc",
                                          "vCont;c",
                                          "Z0,1000,2",
                                          "Z2,ffe100,2",
                                          "z0,1000,2",
                                          "qSupported",
                                          "qXfer:memory-map:read::0,100",
                                          "qRcmd,68656c70",
                                          "vFlashErase:0,400",
                                          "vFlashWrite:0:abc",
                                          "vFlashDone",
                                          "T1",
                                          "H",
                                          "R00"};
  Chip chip = busy_chip();
  GdbServer server(chip, {1000, 4});
  for (int n = 0; n < 4000; ++n) {
    std::string packet = seeds[random() % seeds.size()];
    for (unsigned k = random() % 4; k > 0; --k) {
      const auto c = static_cast<char>(random());
      if (random() % 2 && !packet.empty())
        packet[random() % packet.size()] = c;
      else
        packet.insert(random() % (packet.size() + 1), 1 + random() % 9, c);
    }
    std::string bytes = gdb_frame(packet);
    if (random() % 10 == 0) bytes[random() % bytes.size()] = static_cast<char>(random());
    server.feed({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    if (server.running()) server.run(200);
    EXPECT_LT(server.take_output().size(), 4 * kMaxPacket);
    if (server.finished()) break;
  }
  const std::string endless(3 * kMaxPacket, 'm');
  GdbServer other(chip);
  const std::string framed = gdb_frame(endless);
  other.feed({reinterpret_cast<const std::uint8_t*>(framed.data()), framed.size()});
  EXPECT_EQ(other.take_output(), "-");
}

TEST(Gdb, OverASocket) {
  auto port = GdbPort::open("0");
  ASSERT_TRUE(port.has_value()) << port.error().message;
  ASSERT_GT(port->port(), 0);
  std::thread gdb([number = port->port()] {
    const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(number));
    ASSERT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
    GdbFraming framing;
    std::vector<GdbInput> got;
    const auto send_bytes = [&](const std::string& bytes) -> std::string {
      EXPECT_EQ(::write(fd, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
      got.clear();
      std::array<std::uint8_t, 4096> buffer{};
      while (got.empty()) {
        const ssize_t n = ::read(fd, buffer.data(), buffer.size());
        if (n <= 0) return "closed";
        framing.feed({buffer.data(), static_cast<std::size_t>(n)}, got);
      }
      return got.back().data;
    };
    EXPECT_EQ(send_bytes(gdb_frame("Z0,100c,2")), "OK");
    EXPECT_TRUE(has(send_bytes(gdb_frame("c")), "swbreak"));
    EXPECT_TRUE(has(send_bytes(gdb_frame("bs")), "09:00001008"));
    EXPECT_EQ(send_bytes(gdb_frame("z0,100c,2")), "OK");
    // Runs until Ctrl-C.
    EXPECT_EQ(::write(fd, "$c#63", 5), 5);
    EXPECT_TRUE(send_bytes("\x03").starts_with("T02"));
    EXPECT_EQ(send_bytes(gdb_frame("k")), "closed");
    ::close(fd);
  });
  Chip chip = small_chip();
  GdbServer server(chip);
  const auto served = port->serve(server, 1000);
  EXPECT_TRUE(served.has_value());
  gdb.join();
  EXPECT_TRUE(server.finished());
}

// A GdbPort in a thread, and clients of it.
class ServedChip {
 public:
  ServedChip() {
    EXPECT_EQ(::pipe2(stop_, O_CLOEXEC), 0);
    thread_ = std::thread([this] {
      served_ = port_.serve(server_, 1000, stop_[0], [this](const std::string& line) {
        const std::lock_guard lock(mutex_);
        said_ += line;
      });
      done_.set_value();
    });
  }
  ~ServedChip() {
    stop();
    thread_.join();
    for (const int fd : stop_) ::close(fd);
  }
  int connect() const {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    connect(fd);
    return fd;
  }
  void connect(int fd) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(port_.port()));
    EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
    const timeval limit{10, 0};
    ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  }
  void stop() { EXPECT_EQ(::write(stop_[1], "x", 1), 1); }
  bool ends_within(std::chrono::milliseconds limit) {
    return ended_.wait_for(limit) == std::future_status::ready;
  }
  std::string said() {
    const std::lock_guard lock(mutex_);
    return said_;
  }

 private:
  int stop_[2] = {-1, -1};
  Chip chip_ = small_chip();
  GdbServer server_{chip_};
  GdbPort port_ = GdbPort::open("0").value();
  Result<void> served_;
  std::promise<void> done_;
  std::future<void> ended_ = done_.get_future();
  std::mutex mutex_;
  std::string said_;
  std::thread thread_;
};

void send_text(int fd, const std::string& text) {
  EXPECT_EQ(::send(fd, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
}

// What comes until there is `end`, or the other end closes.
std::string receive_until(int fd, char end) {
  std::string text;
  for (char byte = 0; byte != end && ::recv(fd, &byte, 1, 0) == 1;) text += byte;
  return text;
}

// A browser can be made to send this by any page.
TEST(Gdb, AWebPageIsDisconnectedAndTheNextClientIsGdb) {
  ServedChip chip;
  // A page whose name is rebound to this machine chooses the method, even one that is a packet.
  for (const std::string& method : {std::string("POST"), std::string("PROPFIND"), std::string("+"),
                                    std::string("+$"), gdb_frame("k")}) {
    const int page = chip.connect();
    send_text(page, method + " / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n" + gdb_frame("k"));
    EXPECT_EQ(receive_until(page, '#'), "") << method;
    ::close(page);
  }
  ::close(chip.connect());  // a page may open a connection and say nothing
  const int gdb = chip.connect();
  send_text(gdb, gdb_frame("?"));
  EXPECT_EQ(receive_until(gdb, '#'), "+$S05#") << "the chip was killed";
  ::close(gdb);
  EXPECT_TRUE(chip.ends_within(std::chrono::seconds(10)));
  EXPECT_TRUE(has(chip.said(),
                  "a client was disconnected, because its first bytes can come from a web browser"))
      << chip.said();
}

// A browser connects ahead of a request that may never come.
TEST(Gdb, ASilentClientGivesWayToTheNextOne) {
  ServedChip chip;
  const int silent = chip.connect();
  const int undecided = chip.connect();
  send_text(undecided, "+$g");
  EXPECT_EQ(receive_until(silent, '#'), "");
  const int gdb = chip.connect();
  send_text(gdb, gdb_frame("?"));
  EXPECT_EQ(receive_until(gdb, '#'), "+$S05#");
  const int late = chip.connect();
  send_text(gdb, gdb_frame("?"));
  EXPECT_EQ(receive_until(gdb, '#'), "b8+$S05#") << "one that has spoken stays";
  for (const int fd : {silent, undecided, gdb, late}) ::close(fd);
  EXPECT_TRUE(chip.ends_within(std::chrono::seconds(10)));
}

TEST(Gdb, WithoutADescriptorItWaitsAndThenServesTheClient) {
  ServedChip chip;
  const int gdb = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  rlimit before{};
  ::getrlimit(RLIMIT_NOFILE, &before);
  const rlimit none{static_cast<rlim_t>(gdb) + 1, before.rlim_max};  // it was the lowest free one
  ::setrlimit(RLIMIT_NOFILE, &none);
  chip.connect(gdb);
  EXPECT_FALSE(chip.ends_within(std::chrono::milliseconds(300)));
  ::setrlimit(RLIMIT_NOFILE, &before);
  send_text(gdb, gdb_frame("?"));
  EXPECT_EQ(receive_until(gdb, '#'), "+$S05#");
  ::close(gdb);
  EXPECT_TRUE(chip.ends_within(std::chrono::seconds(10)));
}

TEST(Gdb, AClientThatDoesNotReadCannotKeepTheServer) {
  ServedChip chip;
  const int gdb = chip.connect();
  const int small = 4096;
  ::setsockopt(gdb, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
  // Until nothing more is taken: the server waits for its replies to be read.
  const timeval limit{1, 0};
  ::setsockopt(gdb, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  send_text(gdb, gdb_frame("?"));
  EXPECT_EQ(receive_until(gdb, '#'), "+$S05#");
  const std::string request = gdb_frame("m0,1ff0");
  while (::send(gdb, request.data(), request.size(), MSG_NOSIGNAL) > 0) continue;
  chip.stop();
  EXPECT_TRUE(chip.ends_within(std::chrono::seconds(10)));
  ::close(gdb);
}

TEST(Gdb, PortsThatCannotBe) {
  for (const char* where : {"", "65536", "12x", "-1", "/no/such/folder/socket"}) {
    const auto port = GdbPort::open(where);
    ASSERT_FALSE(port.has_value()) << where;
    EXPECT_FALSE(port.error().message.empty());
  }
}

}  // namespace
}  // namespace kaz::h8s::testing
